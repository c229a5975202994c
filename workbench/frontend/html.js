/**
 * HTML made in Python whose buttons and rows act: whatever has a `data-action` sends it with its `data-value`.
 * Rows of a `data-list` are walked with the arrow keys; the focus survives when the text is written anew.
 */

function placeOf(node) {
  const { action, value } = node?.dataset ?? {};
  return action && `[data-action="${CSS.escape(action)}"][data-value="${CSS.escape(value ?? "")}"]`;
}

/** Scroll a list, and nothing around it, so that a row of it can be seen. */
function showRow(rows, row) {
  if (!row) return;
  const head = rows.querySelector("thead")?.offsetHeight ?? 0;
  const [list, own] = [rows.getBoundingClientRect(), row.getBoundingClientRect()];
  if (own.top < list.top + head) rows.scrollTop -= list.top + head - own.top;
  else if (own.bottom > list.bottom) rows.scrollTop += own.bottom - list.bottom;
}

/** Put the text of a field on the clipboard and say so on the button; a page without leave to, selects it. */
async function copyFrom(field, button) {
  button.dataset.label ??= button.textContent; // a second click finds "Copied" there
  try {
    await navigator.clipboard.writeText(field.value);
    button.textContent = "Copied";
  } catch {
    field.focus();
    field.select();
    button.textContent = document.execCommand("copy") ? "Copied" : "Press Ctrl C";
  }
  setTimeout(() => (button.textContent = button.dataset.label), 1500);
}

/** Panel entry point. */
export function renderHtml({ model, el }) {
  const root = document.createElement("div");
  root.className = "vsw-html";
  const focused = () => root.getRootNode().activeElement;
  const draw = () => {
    const had = root.contains(focused()) ? focused() : null;
    const place = placeOf(had);
    const list = had?.closest("[data-list]")?.dataset.list;
    const scrolled = [...root.querySelectorAll(".rows")].map((e) => [e.className, e.scrollTop]);
    root.innerHTML = model.html;
    for (const rows of root.querySelectorAll(".rows")) {
      rows.scrollTop = scrolled.find(([name]) => name === rows.className)?.[1] ?? 0;
      showRow(rows, rows.querySelector(".now"));
    }
    if (!had) return;
    const same = place && root.querySelector(place);
    const inList = list && root.querySelector(`[data-list="${CSS.escape(list)}"] .now[data-action]`);
    (inList || same)?.focus({ preventScroll: true });
  };
  const act = (node) => model.send_msg({ action: node.dataset.action, value: node.dataset.value ?? "" });
  root.addEventListener("click", (event) => {
    const copier = event.target.closest("[data-copy]");
    if (copier) return copyFrom(root.querySelector(`#${CSS.escape(copier.dataset.copy)}`), copier);
    const node = event.target.closest("[data-action]");
    if (!node || node.disabled) return;
    node.focus({ preventScroll: true });
    act(node);
  });
  root.addEventListener("keydown", (event) => {
    const node = event.target.closest("[data-action]");
    if (!node || event.altKey || event.ctrlKey || event.metaKey) return;
    const rows = [...(node.closest("[data-list]")?.querySelectorAll("[data-action]") ?? [])];
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step && rows.length) {
      event.preventDefault();
      event.stopPropagation();
      const next = rows[(rows.indexOf(node) + step + rows.length) % rows.length];
      next.focus();
      if (node.closest("[data-list]").dataset.follow !== undefined) act(next);
    } else if (event.key === "Enter" && node.tagName !== "BUTTON") {
      event.preventDefault();
      act(node);
    }
  });
  model.on("html", draw);
  draw();
  return root;
}
