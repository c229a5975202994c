/** Whether a button of the mouse, or a finger, is down anywhere on the page: in a drag what is costly waits. */

let down = false;
for (const [type, value] of [
  ["pointerdown", true],
  ["pointerup", false],
  ["pointercancel", false],
  ["blur", false],
]) {
  globalThis.addEventListener?.(
    type,
    (event) => {
      // an element that loses the focus, as one does when another is pressed, is not the window that does
      if (type !== "blur" || event.target === globalThis) down = value;
    },
    true,
  );
}

/** @returns {boolean} */
export function pressed() {
  return down;
}
