/**
 * The frame of every dashboard: rail, bar, transport row, work area, inspector, status line.
 * Places and sizes are fixed; only the work area grows. Children are Panel components that stay where they
 * are: the start page and the work area are both there, and one of them is shown.
 */
import { clock } from "./clock.js";
import { buildConnection } from "./connection.js";
import { deepFind, focusOverlap } from "./deep.js";
import { caretFollows, leaveFields } from "./focus.js";

const JOBS_MS = 400;
const PLACES = { bar: "div", transport: "div", work: "main", start: "main" };
const LOGO = `<svg viewBox="0 0 32 20" width="28" height="18" fill="none" stroke="currentColor"
  stroke-width="1.8" stroke-linejoin="round" aria-hidden="true"><path d="M1 10C6 3 10 1.500 12.500 1.500c1.500
  0 2.300 1.200 3.500 1.200s2-1.200 3.500-1.200C22 1.500 26 3 31 10c-4 5.500-9 8.500-15 8.500S5 15.500 1 10Z"/>
  <path d="M6 10c4-1.200 6.500-1.600 10-1.600s6 .4 10 1.600c-4 1.400-6.500 2-10 2s-6-.6-10-2Z"/></svg>`;
const ICONS = {
  corpus: "M4 6h16M4 12h16M4 18h10",
  blend: "M3 6c7 0 11 12 18 12M3 18c7 0 11-12 18-12",
  keys: "M9.500 9a2.500 2.500 0 1 1 3.800 2.200c-.9.500-1.300 1-1.300 2M12 17v.2",
};

function icon(name) {
  return `<svg viewBox="0 0 24 24" width="20" height="20" fill="none" stroke="currentColor"
    stroke-width="1.700" stroke-linecap="round" stroke-linejoin="round" aria-hidden="true"><path
    d="${ICONS[name] ?? ""}"/></svg>`;
}

/** Register the fonts with the document once: rules inside a shadow root would not count. */
function loadFonts(fonts) {
  for (const { family, url, range } of fonts) {
    const key = `vsw-font-${url}`;
    if (globalThis[key] || typeof FontFace === "undefined") continue;
    globalThis[key] = true;
    const face = new FontFace(family, `url("${url}")`, {
      weight: "100 900",
      unicodeRange: range,
      display: "swap",
    });
    document.fonts.add(face);
  }
}

/** True when a key press belongs to a text field or an open list, not to the page. */
function typing(event) {
  return event.composedPath().some((n) => {
    if (!n.tagName) return false;
    if (n.isContentEditable || n.tagName === "TEXTAREA" || n.tagName === "SELECT") return true;
    if (n.tagName === "INPUT") return !["range", "checkbox", "radio", "button"].includes(n.type);
    return n.getAttribute?.("role") === "listbox" && n.classList?.contains("MuiList-root");
  });
}

function keyName(event) {
  const key = event.key === " " ? "Space" : event.key;
  const held = event.ctrlKey || event.metaKey;
  const shifted = event.shiftKey && (key.length > 1 || held);
  const before = (held ? "Ctrl+" : "") + (event.altKey ? "Alt+" : "") + (shifted ? "Shift+" : "");
  return before + (key.length === 1 ? key.toLowerCase() : key);
}

/** Find the binding of a key press: [binding, which of its keys]. */
export function findBinding(bindings, name) {
  for (const binding of bindings) {
    const index = binding.keys.indexOf(name);
    if (index >= 0) return [binding, index];
  }
  return null;
}

function buildRail(model, root) {
  const rail = document.createElement("nav");
  rail.className = "rail";
  rail.setAttribute("aria-label", "Dashboards");
  const draw = () => {
    rail.innerHTML = `<div class="logo" title="Visual speech workbench">${LOGO}</div>`;
    for (const item of model.dashboards) {
      const button = document.createElement("button");
      button.type = "button";
      button.className = "rail-item";
      button.dataset.id = item.id;
      button.setAttribute("aria-current", item.id === model.active ? "page" : "false");
      button.innerHTML = `${icon(item.id)}<span>${item.label}</span>`;
      button.onclick = () => model.send_msg({ type: "rail", id: item.id });
      rail.append(button);
    }
    const help = document.createElement("button");
    help.type = "button";
    help.className = "rail-item help";
    help.innerHTML = `${icon("keys")}<span>Keys</span>`;
    help.setAttribute("aria-haspopup", "dialog");
    help.onclick = () => toggleHelp(root);
    rail.append(help);
  };
  draw();
  model.on("dashboards", draw);
  model.on("active", draw);
  return rail;
}

function buildHelp(model, root) {
  const help = document.createElement("div");
  help.className = "help-sheet";
  help.hidden = true;
  help.setAttribute("role", "dialog");
  help.setAttribute("aria-label", "Keys");
  const rows = model.bindings.map((b) => `<tr><td><kbd>${b.caption}</kbd></td><td>${b.label}</td></tr>`);
  help.innerHTML = `<h2>Keys</h2><table>${rows.join("")}</table>
    <p>Letters act only while no text field has the focus.</p>`;
  root.append(help);
  return help;
}

function toggleHelp(root, show) {
  const help = root.querySelector(".help-sheet");
  help.hidden = show === undefined ? !help.hidden : !show;
}

function buildStatus(model) {
  const line = document.createElement("footer");
  line.className = "status";
  const left = document.createElement("span");
  left.className = "status-left";
  left.setAttribute("role", "status");
  const time = document.createElement("span");
  const keys = document.createElement("span");
  keys.className = "status-keys";
  const right = document.createElement("span");
  right.className = "status-right";
  line.append(left, time, keys, right);
  let later = 0; // what is done by then is not told: each picture of the page takes its time
  const jobs = () => {
    clearTimeout(later);
    later = setTimeout(() => (right.textContent = model.jobs_text), model.jobs_text === "idle" ? 0 : JOBS_MS);
  };
  const draw = () => {
    left.textContent = model.status_text;
    time.innerHTML = model.measured;
    const shown = model.bindings.filter((b) => model.status_keys.includes(b.id));
    keys.innerHTML = shown.map((b) => `<span><kbd>${b.caption}</kbd> ${b.short}</span>`).join("");
  };
  draw();
  jobs();
  for (const name of ["status_text", "measured", "status_keys"]) model.on(name, draw);
  model.on("jobs_text", jobs);
  return line;
}

/**
 * Call `then` once the controls in `place` are mounted and listen: a control that is changed between its first
 * drawing and its first listening keeps the old value. After `most` looks without one it is called anyway.
 */
function whenMounted(place, then, most = 150) {
  let [seen, count] = [0, 0];
  const look = () => {
    count += 1;
    if (deepFind(place, (e) => e.tagName === "BUTTON")) seen += 1;
    if (seen > 3 || count > most) then();
    else setTimeout(look, 20); // not at the next picture: a tab in the background draws none
  };
  look();
}

/** Panel entry point. */
export function renderShell({ model, el, view }) {
  el.style.width = el.style.height = "100%";
  loadFonts(model.fonts);
  const root = document.createElement("div");
  const place = () => {
    root.className = `vsw-shell${model.fill ? " fill" : ""}${model.starting ? " starting" : ""}`;
    root.dataset.theme = model.theme;
    if (!model.fill) return;
    document.documentElement.dataset.theme = model.theme;
    document.body.style.margin = "0";
    document.title = model.page_title;
  };
  place();
  for (const name of ["theme", "starting", "page_title"]) model.on(name, place);
  root.append(buildRail(model, root));
  const fillSlot = (place, name) => {
    place.append(model.get_child(name));
    return place;
  };
  for (const [name, tag] of Object.entries(PLACES)) {
    const place = document.createElement(tag);
    place.className = name;
    root.append(fillSlot(place, name));
  }
  const inspector = document.createElement("aside");
  inspector.className = "inspector";
  inspector.setAttribute("aria-label", "Inspector");
  for (const [name, className] of [
    ["inspector", "scroll"],
    ["inspector_foot", "foot"],
  ]) {
    const place = document.createElement("div");
    place.className = className;
    inspector.append(fillSlot(place, name));
  }
  root.append(inspector);
  root.append(buildStatus(model));
  root.append(buildConnection(view?.model?.document));
  buildHelp(model, root);

  const drawer = document.createElement("button");
  drawer.type = "button";
  drawer.className = "drawer-toggle";
  drawer.textContent = "Details";
  drawer.onclick = () => root.classList.toggle("drawer-open");
  root.append(drawer);

  const onKey = (event) => {
    if (event.defaultPrevented) return;
    const name = keyName(event);
    const found = findBinding(model.bindings, name);
    if (!found || found[0].scope === "transport") return;
    if (typing(event) && name !== "Escape") return;
    const [binding, index] = found;
    if (binding.id === "help") return toggleHelp(root);
    if (binding.id === "cancel") toggleHelp(root, false);
    event.preventDefault();
    if (binding.id === "overlap") return focusOverlap(root);
    const local = { binding: binding.id, index, handled: false };
    clock(model.session).dispatchEvent(new CustomEvent("key", { detail: local }));
    if (!local.handled) model.send_msg({ type: "key", id: binding.id, index });
  };
  document.addEventListener("keydown", onKey);
  leaveFields(root);
  caretFollows(root.querySelector(".bar"));
  model.on("remove", () => document.removeEventListener("keydown", onKey));
  whenMounted(root.querySelector(".bar"), () => model.send_msg({ type: "ready" }));
  return root;
}
