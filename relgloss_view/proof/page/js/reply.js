// The answer: the settings shown and a note, saved as a new file that names the proof it answers.

import { byId, make } from "../../../base/js/elements.js";
import { say } from "../../../base/js/sentences.js";

const NAME_LENGTH = 12; // digits of a digest that are shown
const LONGEST_STEM = 60; // characters of a file's name
const MOST_NOTE = 20000, MOST_NAME = 200; // characters that a message can have

/** A name for the answer's file: the title, and which message of the thread it is. */
export function fileName(title, number) {
  const stem = title.normalize("NFC").replace(/[^\p{L}\p{N}]+/gu, "-").replace(/^-+|-+$/g, "");
  return `${stem.slice(0, LONGEST_STEM) || "proof"}-${number}.html`;
}

/** A name that a browser opens as a page. */
export function withEnding(name) {
  const stem = name.trim().replace(/[. ]+$/, "");
  return /\.html?$/i.test(stem) ? stem : `${stem || "proof"}.html`;
}

/** The form of an answer. app: proof, digest, settings(), changed(), screen, answered(message). */
export function reply(app) {
  let saved = true;
  const touch = () => {
    saved = false;
    status.textContent = "";
  };
  const note = make("textarea", {
    id: "reply-note", class: "field", rows: 4, maxlength: MOST_NOTE, autocapitalize: "sentences",
    on: { input: touch },
  });
  const name = make("input", {
    id: "reply-name", class: "field", autocomplete: "name", autocapitalize: "words",
    maxlength: MOST_NAME, enterkeyhint: "next", on: { input: touch },
  });
  const file = make("input", {
    id: "reply-file", class: "field", spellcheck: "false", autocapitalize: "none",
    autocorrect: "off", enterkeyhint: "done",
    value: fileName(app.proof.content.title ?? "", app.proof.messages.length + 1),
  });
  const status = make("p", { id: "reply-status", class: "quiet", role: "status" });
  const save = make("button", {
    type: "button", id: "reply-save", class: "button first", text: say("reply.save"),
    on: {
      click: () => {
        const html = app.answered({ note: note.value.trim(), author: name.value.trim() });
        file.value = withEnding(file.value);
        download(html, file.value);
        saved = true;
        app.saved();
        status.textContent = say("reply.saved", { file: file.value });
      },
    },
  });
  const field = (id, text, input) => make("div", { class: "stacked" },
    make("label", { for: id, text }), input);
  const element = make("section", { id: "reply" },
    make("h2", { text: say("reply.title") }),
    make("p", { class: "quiet", text: say("reply.how", {
      name: app.digest.slice(0, NAME_LENGTH),
    }) }),
    field("reply-note", say("reply.note"), note), field("reply-name", say("reply.name"), name),
    field("reply-file", say("reply.file"), file), save, status);
  byId("thread").after(element);
  window.addEventListener("beforeunload", (event) => {
    if (!saved || app.unsaved()) event.preventDefault();
  });
}

function download(html, name) {
  const address = URL.createObjectURL(new Blob([html], { type: "text/html" }));
  const link = make("a", { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}
