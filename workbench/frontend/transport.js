/**
 * The transport: master of the session's clock. To start, play or pause, loop, speed, the clock with the phone
 * it stands on, and the overview of the whole utterance.
 */
import { clock } from "./clock.js";
import { Overview, phoneAt } from "./overview.js";
import { Sound, decodePcm } from "./sound.js";

const SPEEDS = [1, 0.5, 0.25];
const REPORT_MS = 150;
const PATHS = {
  start: "M6 5h2.5v14H6zM19 5v14l-9.500-7z",
  play: "M7 4.500v15l12.500-7.500z",
  pause: "M7 5h3.500v14H7zM13.500 5H17v14h-3.500z",
  loop: "M17 3l4 4-4 4V8H8a4 4 0 0 0-4 4H2a6 6 0 0 1 6-6h9zM7 21l-4-4 4-4v3h9a4 4 0 0 0 4-4h2a6 6 0 0 1-6 6H7z",
};

function icon(name) {
  return `<svg viewBox="0 0 24 24" width="16" height="16" fill="currentColor" aria-hidden="true"><path
    d="${PATHS[name]}"/></svg>`;
}

function button(name, label, onclick) {
  const made = document.createElement("button");
  made.type = "button";
  made.className = name;
  made.innerHTML = PATHS[name] ? icon(name) : "";
  made.title = label;
  made.setAttribute("aria-label", label);
  made.onclick = onclick;
  return made;
}

/** Whether a control was clicked at, or one was in whose place it was drawn since: lists are written anew. */
function wasClicked(node, clicked) {
  const said = JSON.stringify(node.dataset);
  const again = (n) => !n.isConnected && n.tagName === node.tagName && JSON.stringify(n.dataset) === said;
  return clicked.includes(node) || (said !== "{}" && clicked.some(again));
}

/** Whether Space belongs to what has the focus: a text field, or a control that was not clicked at. */
function keepsSpace(event, clicked) {
  const node = event.composedPath()[0];
  if (!node?.tagName) return false;
  if (node.isContentEditable || node.tagName === "TEXTAREA" || node.tagName === "SELECT") return true;
  if (node.tagName === "INPUT" && !["range", "checkbox", "radio", "button"].includes(node.type)) return true;
  const acts =
    node.tagName === "BUTTON" || ["button", "option", "menuitem"].includes(node.getAttribute("role"));
  return acts && !wasClicked(node, clicked);
}

function buildClock() {
  const face = document.createElement("div");
  face.className = "clock";
  face.innerHTML = `<span class="now" role="timer" aria-label="Clock">0.000</span><span class="of"></span><span
    class="phone" aria-label="Phone at the clock"></span>`;
  const [now, of, phone] = face.children;
  return { face, now, of, phone };
}

/** Panel entry point. */
export function renderTransport({ model, el }) {
  el.style.width = el.style.height = "100%";
  const clk = clock(model.session);
  const sound = new Sound(clk);
  let phones = [];
  let speed = SPEEDS[0];
  let loop = false;
  let timer = 0;

  const play = async (from, to) => {
    await sound.play(from, to, { speed, loop });
    root.classList.toggle("silent", Boolean(sound.silent));
    root.title = sound.silent ? `No sound: ${sound.silent}` : "";
  };
  const ends = () => (loop && clk.view ? clk.view : [0, sound.duration]);
  const toggle = () => {
    if (clk.playing) return sound.halt();
    const [first, last] = ends();
    const inside = clk.t >= first && clk.t < last - 0.01;
    return play(inside && !loop ? clk.t : first, last);
  };
  const again = () => clk.playing && play(loop ? ends()[0] : clk.t, ends()[1]);
  const obey = {
    play: ({ from, to }) => play(Math.max(0, from), Math.min(sound.duration, to)),
    stop: () => sound.halt(),
    seek: ({ t }) => clk.seek(t),
    hear: ({ pcm, rate }) => sound.hear(decodePcm(pcm), rate),
  };
  const onSeek = () => clk.playing && play(clk.t, sound.duration);

  const root = document.createElement("div");
  root.className = "vsw-transport";
  root.setAttribute("role", "toolbar");
  root.setAttribute("aria-label", "Transport");
  const toStart = button("start", "To the start", () => sound.halt(0));
  const playButton = button("play", "Play (Space)", toggle);
  const loopButton = button("loop", "Play round and round", () => {
    loop = !loop;
    loopButton.setAttribute("aria-pressed", String(loop));
    again();
  });
  loopButton.setAttribute("aria-pressed", "false");
  const speedButton = button("speed", "Speed; slower is also lower", () => {
    speed = SPEEDS[(SPEEDS.indexOf(speed) + 1) % SPEEDS.length];
    speedButton.textContent = `${speed}×`;
    again();
  });
  speedButton.textContent = "1×";
  const { face, now, of, phone } = buildClock();
  const data = () => ({ samples: sound.samples, rate: sound.rate, duration: sound.duration, phones });
  const player = { stop: () => sound.halt(), play: toggle };
  const overview = new Overview(clk, data, () => model.palettes[model.theme], player);
  root.append(toStart, playButton, loopButton, speedButton, face, overview.root);

  const report = () => {
    clearTimeout(timer);
    timer = setTimeout(() => (model.time = clk.t), REPORT_MS);
  };
  const show = (t, playing) => {
    now.textContent = t.toFixed(3);
    const here = phoneAt(phones, t);
    phone.textContent = here ? `/${here[2]}/` : "";
    overview.move(t);
    if (!playing) report();
  };
  const state = () => {
    playButton.innerHTML = icon(clk.playing ? "pause" : "play");
    const label = clk.playing ? "Pause (Space)" : "Play (Space)";
    playButton.title = label;
    playButton.setAttribute("aria-label", label);
  };
  const load = () => {
    const loaded = { rate_hz: 16000, duration_s: 0, phones: [], ...model.loaded };
    sound.load(decodePcm(loaded.pcm), loaded.rate_hz, loaded.duration_s);
    phones = loaded.phones;
    of.textContent = `s / ${sound.duration.toFixed(3)}`;
    for (const b of [toStart, playButton, loopButton, speedButton]) b.disabled = !(sound.duration > 0);
    show(clk.t, false);
    overview.ask();
  };
  const paint = () => {
    root.dataset.theme = model.theme;
    overview.ask();
  };
  let clicked = []; // a button that got the focus by a click leaves Space to the transport
  const onPointer = (event) => (clicked = event.composedPath());
  const onKey = (event) => {
    if (event.key === "Tab") clicked = [];
    if (event.key !== " " || event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
    if (!(sound.duration > 0) || keepsSpace(event, clicked)) return;
    event.preventDefault();
    if (event.shiftKey) play(0, sound.duration);
    else toggle();
  };
  const listenTo = model.keys_everywhere ? document : root;
  listenTo.addEventListener("keydown", onKey);
  listenTo.addEventListener("pointerdown", onPointer, true);
  clk.addEventListener("seek", onSeek);
  clk.addEventListener("state", state);
  const onView = () => overview.moveWindow();
  clk.addEventListener("view", onView);
  paint();
  load();
  const off = clk.add(show);
  const begin = () => {
    load();
    if (model.loaded.plays && sound.duration > 0) play(0, sound.duration);
  };
  model.on("loaded", begin);
  model.on("theme", paint);
  model.on("msg:custom", (message) => sound.duration > 0 && obey[message.op]?.(message));
  root.vsw = { clock: clk, sound, overview };
  model.on("remove", () => {
    clearTimeout(timer);
    off();
    overview.close();
    listenTo.removeEventListener("keydown", onKey);
    listenTo.removeEventListener("pointerdown", onPointer, true);
    clk.removeEventListener("seek", onSeek);
    clk.removeEventListener("state", state);
    clk.removeEventListener("view", onView);
    sound.close();
  });
  return root;
}
