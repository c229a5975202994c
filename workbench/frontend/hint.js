/** A sentence over a view that goes away by itself. */

const SHOWN_MS = 1500;
const STYLE =
  "position:absolute;left:50%;bottom:12px;transform:translateX(-50%);margin:0;padding:3px 10px;border-radius:4px;" +
  "pointer-events:none;white-space:nowrap;font:500 12px/16px var(--vsw-font, sans-serif);" +
  "color:var(--vsw-panel);background:var(--vsw-ink)";

export class Hint {
  /**
   * @param {HTMLElement} box what it stands in
   * @param {string} text
   */
  constructor(box, text) {
    this.line = document.createElement("p");
    this.line.className = "hint";
    this.line.setAttribute("role", "status");
    this.line.style.cssText = STYLE;
    this.line.textContent = text;
    this.line.hidden = true;
    this.timer = 0;
    box.append(this.line);
  }

  show() {
    this.line.hidden = false;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => (this.line.hidden = true), SHOWN_MS);
  }

  dispose() {
    clearTimeout(this.timer);
    this.line.remove();
  }
}
