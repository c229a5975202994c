/**
 * The work area of the blend page: face, g(u) and lane as cards that keep their places.
 */

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

function legend() {
  const key = document.createElement("span");
  key.className = "legend";
  key.innerHTML =
    '<i class="now"></i>now <i class="recorded"></i>recorded <i class="overlap"></i>overlap ' +
    '<i class="threshold"></i>closed below';
  return key;
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
  face.card.append(tag);

  const curve = section("weighting", "g(u) at the joins");
  curve.card.append(slot(model, "presets"), slot(model, "plot"), slot(model, "sliders"));

  const lane = section("fragments", "Fragments");
  const sub = document.createElement("span");
  sub.className = "sub";
  const chip = document.createElement("span");
  chip.className = "chip";
  lane.head.append(sub, legend(), chip);
  const notice = document.createElement("div");
  notice.className = "notice err band";
  notice.setAttribute("role", "alert");
  lane.card.append(notice, slot(model, "lane"));

  const draw = () => {
    tag.textContent = model.head_text;
    sub.textContent = model.lane_text;
    chip.textContent = model.held_out_text;
    chip.hidden = !model.held_out_text;
    notice.hidden = !model.message;
    notice.textContent = model.message ? `✕ ${model.message}` : "";
    root.classList.toggle("stale", model.stale);
  };
  for (const name of ["head_text", "lane_text", "held_out_text", "message", "stale"]) model.on(name, draw);
  draw();
  root.append(face.card, curve.card, lane.card);
  return root;
}
