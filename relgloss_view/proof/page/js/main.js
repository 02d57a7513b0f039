// What runs when the page is opened: check, draw, and hand over to whoever looks.

import { App, keepForPaper, notice } from "./app.js";
import { checkPage, checkSignatures, pageText, withMessage, wordsOfPart } from "./canonical.js";
import { byId, make } from "../../../base/js/elements.js";
import { byTouch } from "./dom.js";
import { Engine } from "./engine.js";
import { held, lifeSized, listen, orbited, panned, turned, zoomed } from "./hand.js";
import { lifeSize } from "./life.js";
import { readout } from "./readout.js";
import { mountCheck } from "./check.js";
import { mountScreen } from "./screen.js";
import { reply } from "./reply.js";
import { controls } from "./sliders.js";
import { bringUpToDate, withStatic } from "./static.js";
import { banner, localTimes, signatures, thread } from "./thread.js";
import { tools } from "./tools.js";
import { say } from "../../../base/js/sentences.js";

let pristine = ""; // the text of the page, before anything is changed
const MOST_NAMED = 5; // changed parts that the notice lists

/** Whether what was sealed is what is here, before anything of it is shown. */
async function begin() {
  if (document.readyState === "loading") {
    await new Promise((done) => document.addEventListener("DOMContentLoaded", done));
  }
  pristine = pageText();
  const page = checkPage(pristine);
  Object.assign(window.relgloss, { page, proof: page.proof });
  byId("unchecked").remove();
  if (page.newer || page.changes.length > 0 || !page.readable) changed(page);
  else await open(page);
}

/** Nothing is shown of a changed page before a click, and never of a proof that is not whole. */
function changed(page) {
  const main = byId("main"), names = page.changes.slice(0, MOST_NAMED)
    .map((part) => say(...wordsOfPart(part)));
  if (page.changes.length > MOST_NAMED) names.push("\u2026");
  const what = names.join(", ");
  main.dataset.state = "changed";
  main.hidden = true;
  notice(page.newer ? say("state.newer") : say("state.changed", { what }));
  if (page.newer || !page.readable) return;
  const button = make("button", {
    type: "button", id: "all-the-same", class: "button", text: say("state.all-the-same"),
    on: {
      click: () => {
        button.remove();
        main.hidden = false;
        notice(say("state.shown-changed", { what }));
        window.relgloss.ready = open(page);
      },
    },
  });
  byId("notice").after(button);
}

/** The canvas in the place of the stored pictures, or the reason why there is none. */
async function open({ proof, shaders, digests, digest, signatures: signed }) {
  const main = byId("main");
  main.dataset.state = "loading";
  bringUpToDate(document, proof.messages);
  localTimes();
  checkSignatures(digests, signed).then(signatures);
  byId("how").append(make("p", { class: "quiet" }, say("how.name"), " ",
    make("code", { text: digest })));
  const canvas = make("canvas", {
    id: "canvas", role: "img", tabindex: 0, "aria-describedby": "keys", hidden: true,
  });
  byId("stage").append(canvas, make("p", { id: "loading", class: "loading", text: say("state.drawing") }));
  let engine;
  try {
    engine = await Engine.open(canvas, proof, shaders);
  } catch (fault) {
    unsupported(fault);
    return;
  }
  canvas.hidden = false;
  const app = new App(engine, canvas, proof);
  app.digest = digest;
  app.answered = (words) => answered(app, words);
  main.dataset.state = "drawing";
  try {
    // Silhouettes of triangles are smoothed by the next frame, so that a pack is seen sooner.
    app.paint(Object.values(engine.forms).some((form) => form?.mesh));
    app.share = 1; // a first frame compiles, so its time says nothing of the next
  } catch (fault) {
    unsupported(fault);
    return;
  }
  arrange(app, canvas);
  app.watch();
  keepForPaper(byId("stage"));
  await app.idle();
  mountCheck(byId("check"), app);
  const screen = mountScreen(byId("screen"), app);
  app.onRest.push(() => screen.update());
  screen.update();
  engine.prepare(app.settings());
}

/** The page of an answer with the settings shown. words: {note, author}. */
function answered(app, { note, author }) {
  const message = {
    author, note, made: new Date().toISOString().replace(/\.\d+Z$/, "Z"), parent: app.digest,
    program: app.proof.messages[0].program, screen: app.screen, settings: app.settings(),
  };
  return withMessage(withStatic(pristine, message), message);
}

/** The stored pictures and words stay, with the reason. */
function unsupported(fault) {
  const known = {
    "no webgl2": "webgl", "no float targets": "float", "no memory": "memory", "few targets": "targets",
    "no inflation": "inflation",
  };
  const reason = known[fault.reason] ?? "unknown";
  byId("main").dataset.state = "unsupported";
  for (const id of ["canvas", "loading"]) byId(id)?.remove();
  notice(say("state.unsupported", { reason: say(`unsupported.${reason}`) }));
  if (fault.reason === undefined) console.error(fault);
}

/** All that is there only where pictures can be drawn. */
function arrange(app, canvas) {
  const shows = [banner(app, app.proof.messages), tools(app, () => life.open()),
    controls(app, app.proof.content.drawing?.lamps ?? [app.present.lamp.illuminant]), thread(app)];
  const reading = readout(app), life = lifeSize(app);
  byId("look").append(make("p", { id: "keys", class: "quiet keys", text: say(byTouch() ? "canvas.touch" : "canvas.keys") }));
  app.onChange(() => shows.forEach((show) => show()));
  app.onRest.push(() => reading.show());
  listen(canvas, Object.assign(Object.create(app), {
    mode: () => app.shown.hand,
    settings: () => app.settings(),
    set: (settings, live) => app.set(settings, live),
    point: reading.point, movePoint: reading.movePoint,
    key: (name) => act(app, name),
  }));
  reply(app);
  app.tell();
  Object.assign(window.relgloss, {
    app, engine: app.engine, settings: () => app.settings(),
    set: (settings) => app.set(settings), idle: () => app.idle(),
    hand: { held, lifeSized, orbited, panned, turned, zoomed },
  });
}

/** Keys of the canvas; returns whether there is such a key. */
function act(app, name) {
  const acts = {
    Home: () => app.lookAt(app.at()), f: () => app.flip(), " ": () => app.flip(),
    s: () => app.show({ mode: "both" }), w: () => app.show({ mode: "wipe" }),
    t: () => app.show({ hand: "turn" }), l: () => app.show({ hand: "lamp" }),
    r: () => app.show({ hand: "read" }), 0: () => app.frameAgain(),
  };
  acts[name]?.();
  return name in acts;
}

window.relgloss = {};
window.relgloss.ready = begin();
