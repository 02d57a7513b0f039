// The texts of the page: one table, which a translation replaces.

const table = JSON.parse(document.getElementById("words").textContent);
const language = document.documentElement.lang;

/** The text of a key with its {placeholders} filled. A key that is missing is an error. */
export function say(key, values = {}) {
  if (!Object.hasOwn(table, key)) throw new Error(`words: ${key}`);
  return table[key].replace(/\{(\w+)\}/g, (_, name) => String(values[name]));
}

/** A number as the table's language writes it, with so many decimals. */
export function figure(value, decimals = 2) {
  return new Intl.NumberFormat(language, {
    minimumFractionDigits: decimals, maximumFractionDigits: decimals,
  }).format(value);
}

/** A time such as 2026-11-27T08:30:00Z in words, in the reader's own time zone. */
export function moment(made) {
  const time = new Date(made);
  if (Number.isNaN(time.getTime())) return made;
  return new Intl.DateTimeFormat(language, { dateStyle: "long", timeStyle: "short" }).format(time);
}
