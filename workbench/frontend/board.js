/**
 * The work area of the blend page: face, g(u) and lane as cards that keep their places.
 */
import { tabId } from "./tab.js";

const SAID_AFTER_MS = 1000;

function section(name, title) {
  const card = document.createElement("section");
  card.className = `card ${name}`;
  const head = document.createElement("header");
  const heading = document.createElement("h2");
  heading.textContent = title;
  head.append(heading);
  card.append(head);
  return { card, head };
}

function slot(model, name) {
  const place = document.createElement("div");
  place.className = `slot ${name}`;
  place.append(model.get_child(name));
  return place;
}

/** What the lines are: solid what is shown, dashed the other of A and B where they differ. */
function legend(model) {
  const key = document.createElement("span");
  key.className = "legend";
  const draw = () => {
    const other = model.side === "A" ? "B" : "A";
    key.innerHTML =
      `<i class="now"></i>${model.compared ? `${model.side}, shown <i class="other"></i>${other} ` : "now "}` +
      '<i class="recorded"></i>recorded <i class="natural"></i>natural 10–90 % <i class="threshold"></i>closed below';
  };
  for (const name of ["side", "compared"]) model.on(name, draw);
  draw();
  return key;
}

/** A | B over the head: which of two settings is shown. */
function sides(model) {
  const group = document.createElement("div");
  group.className = "over sides";
  group.setAttribute("role", "group");
  group.setAttribute("aria-label", "Setting shown");
  const buttons = ["A", "B"].map((side) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = side;
    button.onclick = () => model.send_msg({ type: "action", id: side }); // the server knows which is shown by then
    group.append(button);
    return button;
  });
  const cap = document.createElement("kbd");
  cap.textContent = "X";
  group.append(cap);
  const draw = () => {
    group.hidden = !model.compared;
    for (const b of buttons) b.setAttribute("aria-pressed", String(b.textContent === model.side));
  };
  for (const name of ["side", "compared"]) model.on(name, draw);
  draw();
  return group;
}

/** What can be shown over the head: markers, control surface, attachment. */
function overlays(model) {
  const group = document.createElement("div");
  group.className = "over overlays";
  group.setAttribute("role", "group");
  group.setAttribute("aria-label", "Shown over the head");
  const draw = () => {
    const had = group.getRootNode().activeElement?.dataset?.id;
    group.replaceChildren(
      ...model.overlays.map(({ id, label, on, can }) => {
        const button = document.createElement("button");
        button.type = "button";
        button.textContent = label;
        button.dataset.id = id;
        button.disabled = !can;
        button.setAttribute("aria-pressed", String(on));
        button.onclick = () => model.send_msg({ type: "action", id });
        return button;
      }),
    );
    group.querySelector(`[data-id="${had}"]`)?.focus();
  };
  model.on("overlays", draw);
  draw();
  return group;
}

/** The recording on the same head, small, at the same time. */
function inset(model) {
  const box = document.createElement("figure");
  box.className = "over inset";
  const caption = document.createElement("figcaption");
  caption.textContent = "recorded, same time";
  box.append(slot(model, "inset"), caption);
  const draw = () => box.classList.toggle("gone", !model.inset_shown);
  model.on("inset_shown", draw);
  draw();
  return box;
}

/** Lane | Trajectories: what the lower card shows. */
function views(model) {
  const group = document.createElement("div");
  group.className = "switch";
  group.setAttribute("role", "group");
  group.setAttribute("aria-label", "Lower card");
  for (const [id, label] of [
    ["lane", "Lane"],
    ["curves", "Trajectories"],
  ]) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = label;
    button.dataset.id = id;
    button.title = "Lane or trajectories (V)";
    button.onclick = () => model.send_msg({ type: "action", id });
    group.append(button);
  }
  const draw = () => {
    for (const b of group.children) b.setAttribute("aria-pressed", String(b.dataset.id === model.shown));
  };
  model.on("shown", draw);
  draw();
  return group;
}

/** Progress of a corpus that is being made: what, how far, how long; and how to stop it. */
function progress(model) {
  const box = document.createElement("div");
  box.className = "waiting";
  box.innerHTML = `<h2></h2><div class="progress" role="progressbar" aria-valuemin="0" aria-valuemax="100"
    aria-label="Progress"><i></i></div><p class="doing" role="status"></p><button type="button">Cancel
    <kbd>Esc</kbd></button> <span class="left"></span>`;
  const [title, bar, doing, cancel, left] = box.children;
  cancel.onclick = () => model.send_msg({ type: "action", id: "cancel" });
  const draw = () => {
    const percent = Math.round(100 * model.fraction);
    box.hidden = !model.doing && !model.hint;
    title.textContent = model.doing ? model.title : model.hint;
    bar.hidden = doing.hidden = cancel.hidden = left.hidden = !model.doing;
    bar.firstElementChild.style.width = `${percent}%`;
    bar.setAttribute("aria-valuenow", String(percent));
    doing.textContent = `${model.doing} · ${percent} %`;
    left.textContent = model.left_text;
  };
  for (const name of ["fraction", "doing", "left_text", "hint", "title"]) model.on(name, draw);
  draw();
  return box;
}

/**
 * Says that something is computed when nothing has moved for a second. It is not there before: an indicator that
 * turns unseen lets the browser draw the whole page sixty times a second, in the middle of a drag.
 */
function computing(model) {
  const busy = document.createElement("div");
  busy.className = "over busy";
  busy.setAttribute("role", "status");
  busy.innerHTML = "<i></i>computing <kbd>Esc</kbd>";
  busy.hidden = true;
  let late = 0;
  const wait = () => {
    clearTimeout(late);
    busy.hidden = true;
    if (model.working) late = setTimeout(() => (busy.hidden = false), SAID_AFTER_MS);
  };
  for (const name of ["working", "moves"]) model.on(name, wait);
  wait();
  return busy;
}

/** Let the buttons of g(u) say the name that the config has for it: some are cut. */
function presetsSlot(model) {
  const place = slot(model, "presets");
  place.addEventListener("pointerover", (event) => {
    const button = event.composedPath().find((node) => node.tagName === "BUTTON");
    const name = model.preset_names[button?.getAttribute("aria-label")];
    if (name) button.title = model.unused ? "" : `${name} in the config`;
  });
  return place;
}

/** Panel entry point. */
export function renderBoard({ model, el }) {
  el.style.width = el.style.height = "100%";
  const root = document.createElement("div");
  root.className = "vsw-board";

  const face = section("face", "Head");
  face.card.append(slot(model, "face"));
  const tag = document.createElement("div");
  tag.className = "tag";
  face.card.append(tag, computing(model), sides(model), overlays(model), inset(model));

  const curve = section("weighting", "g(u) at the joins");
  curve.head.append(slot(model, "mode"));
  const presets = presetsSlot(model);
  curve.card.append(presets, slot(model, "plot"), slot(model, "sliders"));

  const lane = section("fragments", "Fragments");
  const sub = document.createElement("span");
  sub.className = "sub";
  const chip = document.createElement("span");
  chip.className = "chip";
  chip.title = "No fragment is from the recording of this sentence; how far lips and chin are from it in speech, rms";
  lane.head.append(sub, legend(model), chip, views(model));
  const notice = document.createElement("div");
  notice.className = "notice err band";
  notice.setAttribute("role", "alert");
  const warning = document.createElement("div");
  warning.className = "notice warn band";
  warning.setAttribute("role", "status");
  const curves = slot(model, "curves");
  const drawing = document.createElement("p"); // behind the plots: they cover it when they are there
  drawing.className = "drawing";
  drawing.textContent = "Drawing the trajectories…";
  curves.prepend(drawing);
  lane.card.append(notice, warning, slot(model, "lane"), curves, progress(model));

  const draw = () => {
    tag.textContent = model.head_text;
    tag.hidden = !model.head_text;
    sub.textContent = model.lane_text;
    sub.title = model.lane_text;
    chip.textContent = model.held_out_text;
    chip.hidden = !model.held_out_text;
    notice.hidden = !model.message;
    notice.textContent = model.message ? `✕ ${model.message}` : "";
    warning.hidden = !model.warning || Boolean(model.message);
    warning.textContent = model.warning ? `▲ ${model.warning}` : "";
    warning.title = model.warning;
    root.classList.toggle("stale", model.stale);
    presets.title = model.unused;
    presets.classList.toggle("unused", Boolean(model.unused));
    root.classList.toggle("curves", model.shown === "curves");
  };
  for (const name of ["head_text", "lane_text", "held_out_text", "message", "warning", "stale", "shown", "unused"]) model.on(name, draw);
  draw();
  root.append(face.card, curve.card, lane.card);
  tabId().then((found) => found && model.send_msg({ type: "tab", ...found }));
  return root;
}
