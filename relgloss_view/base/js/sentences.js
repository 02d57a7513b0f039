// The texts of a page: the table in its block "words", which a translation replaces.

const sentences = JSON.parse(document.getElementById("words").textContent);

/** The text of a key with its {placeholders} filled. A key that is missing is an error. */
export function say(key, values = {}) {
  if (!Object.hasOwn(sentences, key)) throw new Error(`words: ${key}`);
  return sentences[key].replace(/\{(\w+)\}/g, (_, name) => String(values[name]));
}
