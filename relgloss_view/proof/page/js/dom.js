// Elements of the page. Texts go in as text, never as HTML.

export function byId(id) {
  return document.getElementById(id);
}

/** An element: `text`, `class`, `on` ({event: function}) and attributes; true is an empty one. */
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

/** Whether the reader's first pointer is a finger. */
export function byTouch() {
  return window.matchMedia("(pointer: coarse)").matches;
}

/** Buttons of which one is pressed; `choices` are {key: text}. Returns {element, show(key)}. */
export function segments(label, choices, chosen, choose) {
  const buttons = Object.entries(choices).map(([key, text]) => make("button", {
    type: "button", class: "segment", text, "data-key": key, "aria-pressed": key === chosen,
    on: { click: () => choose(key) },
  }));
  const element = make("div", { class: "segments", role: "group", "aria-label": label }, ...buttons);
  const show = (key) => {
    for (const button of buttons) {
      button.setAttribute("aria-pressed", String(button.dataset.key === key));
    }
  };
  show(chosen);
  return { element, show };
}
