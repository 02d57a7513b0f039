// Elements and words of the page. Texts go in as text, never as HTML.

const sentences = JSON.parse(document.getElementById("words").textContent);

export function byId(id) {
  return document.getElementById(id);
}

/** The text of a key with its {placeholders} filled. A key that is missing is an error. */
export function say(key, values = {}) {
  if (!Object.hasOwn(sentences, key)) throw new Error(`words: ${key}`);
  return sentences[key].replace(/\{(\w+)\}/g, (_, name) => String(values[name]));
}

/** An element: `text`, `on` ({event: function}) and attributes; true is an empty one. */
export function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null || value === false) continue;
    if (name === "text") element.textContent = value;
    else if (name === "on") {
      for (const [event, act] of Object.entries(value)) element.addEventListener(event, act);
    } else element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

export function button(text, act, properties = {}) {
  return make("button", { type: "button", class: "button", text, on: { click: act }, ...properties });
}

/** Reads a sentence out to those who listen to the page. */
export function announce(text) {
  byId("live").textContent = text;
}

const SAID_MS = 1600, said = new WeakMap();

/** A button that says for a moment that its text is copied. */
export function copyButton(text, textToCopy, properties = {}) {
  const one = button(text, async () => {
    if (!await copy(textToCopy())) return;
    one.textContent = say("copied");
    clearTimeout(said.get(one));
    said.set(one, setTimeout(() => { one.textContent = text; }, SAID_MS));
  }, properties);
  return one;
}

/** Copies a text; where the browser refuses, selects it for the reader to copy. */
export async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
    announce(say("copied"));
    return true;
  } catch {
    const area = make("textarea", { class: "copied", "aria-label": say("copy.by-hand"), readonly: true });
    area.value = text;
    const box = make("dialog", { class: "dialog" }, make("p", { text: say("copy.by-hand") }), area);
    box.append(button(say("close"), () => box.close()));
    box.addEventListener("close", () => box.remove());
    document.body.append(box);
    box.showModal();
    area.select();
    return false;
  }
}
