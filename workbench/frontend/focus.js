/** Where the focus goes: a field lets go of it when it is done with, and a text that is to be typed gets it. */
import { deepFind } from "./deep.js";

const LOOK_MS = 20;
const MOST_LOOKS = 100;

const isPicker = (node) => node.getAttribute?.("role") === "combobox";
const isText = (node) => node.tagName === "INPUT" && ["text", "search"].includes(node.type);
const isOpen = (node) => node.getAttribute("aria-expanded") === "true";
/** A picker in which was typed what no row has: there is nothing to choose yet. */
const findsNone = (node) => isPicker(node) && isOpen(node) && !node.hasAttribute("aria-controls");

function focused() {
  let node = document.activeElement;
  while (node?.shadowRoot?.activeElement) node = node.shadowRoot.activeElement;
  return node;
}

/** Esc frees any field; Enter a text, and a picker that has something to choose. */
function onKey(event) {
  const field = event.composedPath()[0];
  if (!field?.tagName) return;
  if (event.key === "Escape" && (["INPUT", "TEXTAREA"].includes(field.tagName) || isPicker(field))) {
    setTimeout(() => field.blur());
  }
  if (event.key === "Enter" && isText(field)) {
    setTimeout(() => findsNone(field) || field.blur());
  }
}

/** A row of a picker that was clicked is chosen: the picker is done with. */
function onClick(event) {
  if (!event.composedPath().some((n) => n.classList?.contains("MuiAutocomplete-option"))) return;
  setTimeout(() => {
    const field = focused();
    if (field && isPicker(field) && !isOpen(field)) field.blur();
  });
}

/** Put the caret into the field of class "typed" as soon as it is shown. */
function putCaret(bar, looks = MOST_LOOKS) {
  const shown = deepFind(bar, (e) => e.classList.contains("typed") && e.checkVisibility());
  const field = shown && deepFind(shown.shadowRoot ?? shown, isText);
  if (field) field.focus();
  else if (looks) setTimeout(() => putCaret(bar, looks - 1), LOOK_MS);
}

/**
 * Let the fields below an element let go of the focus, so that the keys of the page act again.
 * @param {HTMLElement} root
 */
export function leaveFields(root) {
  // on the way down: a picker keeps Esc for itself while its list is open
  root.addEventListener("keydown", onKey, true);
  root.addEventListener("click", onClick);
}

/**
 * Let the choice of Text among the buttons of class "kind" put the caret into the text.
 * @param {HTMLElement} bar
 */
export function caretFollows(bar) {
  bar.addEventListener("click", (event) => {
    const path = event.composedPath();
    const text = path.find((n) => n.tagName === "BUTTON")?.value === "Text";
    if (text && path.some((n) => n.classList?.contains("kind"))) putCaret(bar);
  });
}
