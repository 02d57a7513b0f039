// What runs when the page is opened: check, draw, and hand over to whoever looks.

import { App, notice } from "./app.js";
import { byId, make } from "./dom.js";
import { Engine } from "./engine.js";
import { held, lifeSized, listen, orbited, panned, turned, zoomed } from "./hand.js";
import { lifeSize } from "./life.js";
import { readout } from "./readout.js";
import { reply } from "./reply.js";
import { controls } from "./sliders.js";
import { banner, localTimes, thread } from "./thread.js";
import { tools } from "./tools.js";
import { say } from "./words.js";

const pristine = `<!DOCTYPE html>\n${document.documentElement.outerHTML}`;
const block = (name) => JSON.parse(byId(name).textContent);

/** Whether what was sealed is what is here, then the canvas in the place of the stored pictures. */
async function begin() {
  const proof = block("proof");
  window.relgloss.proof = proof;
  const main = byId("main");
  main.dataset.state = "loading";
  localTimes();
  const canvas = make("canvas", {
    id: "canvas", role: "img", tabindex: 0, "aria-describedby": "keys", hidden: true,
  });
  byId("stage").append(canvas, make("p", { id: "loading", class: "loading", text: say("state.drawing") }));
  const open = () => Engine.open(canvas, proof, block("shaders"));
  let engine;
  try {
    engine = await open();
  } catch (fault) {
    unsupported(fault);
    return;
  }
  canvas.hidden = false;
  const app = new App(engine, canvas, proof);
  arrange(app, canvas);
  app.watch(open);
  main.dataset.state = "drawing";
  try {
    await app.frame();
  } catch (fault) {
    unsupported(fault);
    return;
  }
  await app.idle();
}

/** The stored pictures and words stay, with the reason. */
function unsupported(fault) {
  const reason = fault.reason ?? "unknown";
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
  byId("look").append(make("p", { id: "keys", class: "quiet keys", text: say("canvas.keys") }));
  app.onChange(() => shows.forEach((show) => show()));
  app.onRest = () => reading.show();
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

window.relgloss = { ready: begin() };
