// Numbers and times as the language of the page writes them.

const language = document.documentElement.lang;

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
