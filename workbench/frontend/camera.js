/** Trackball: drag turns about the focal point, shift or another button pans, the wheel comes nearer. */
import { add, cross, length, rotate, scale, subtract, unit } from "./linalg.js";

const DOLLY_PER_PX = 0.001;
const SETTLE_MS = 200;
const TURN = Math.PI / 18;
/** A press that moves less than this is a click, px. */
const CLICK_PX = 4;
const ANYWHERE = [0, Infinity];

export class Trackball {
  /**
   * @param {HTMLElement} canvas
   * @param {() => object} home the camera of a reset
   * @param {(settled: boolean) => void} changed called after every change; settled: the hand has let go
   * @param {(event: PointerEvent) => void} clicked called for a press without a drag
   * @param {() => number[]} limits nearest and farthest distance, as shares of that of the camera of a reset
   * @param {(event: WheelEvent) => boolean} zooms whether a wheel is for this picture, not for the page
   */
  constructor(canvas, home, changed, clicked = () => {}, limits = () => ANYWHERE, zooms = () => true) {
    Object.assign(this, { limits, zooms });
    this.canvas = canvas;
    this.home = home;
    this.changed = changed;
    this.clicked = clicked;
    this.camera = home();
    this.drag = null;
    this.timer = 0;
    canvas.addEventListener("pointerdown", (event) => this.grab(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", (event) => this.release(event));
    canvas.addEventListener("pointercancel", () => this.release());
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  /** Right, up and back of the camera, unit vectors. */
  axes() {
    const back = unit(subtract(this.camera.position, this.camera.focal_point));
    const right = unit(cross(this.camera.view_up, back));
    return [right, cross(back, right), back];
  }

  grab(event) {
    if (!this.camera) return;
    const pan = event.button !== 0 || event.shiftKey;
    this.drag = { x: event.clientX, y: event.clientY, pan, far: 0, first: !pan };
    this.canvas.setPointerCapture(event.pointerId);
    this.canvas.focus({ preventScroll: true });
  }

  move(event) {
    if (!this.drag) return;
    const [dx, dy] = [event.clientX - this.drag.x, event.clientY - this.drag.y];
    Object.assign(this.drag, { x: event.clientX, y: event.clientY, far: this.drag.far + Math.hypot(dx, dy) });
    if (this.drag.pan) this.pan(dx, dy);
    else {
      const perPx = Math.PI / (this.canvas.clientHeight || 1);
      this.turn(-dx * perPx, -dy * perPx);
    }
    this.changed(false);
  }

  /** @param {PointerEvent} [event] missing when the press was taken away */
  release(event) {
    if (!this.drag) return;
    const { far, first } = this.drag;
    this.drag = null;
    if (event && first && far < CLICK_PX) this.clicked(event);
    this.changed(true);
  }

  /** Turn by angles in radians about the up and the right axis of the camera. */
  turn(aboutUp, aboutRight) {
    const [right, up] = this.axes();
    const turned = (v) => rotate(rotate(v, up, aboutUp), right, aboutRight);
    const { position, focal_point: focus, view_up: before } = this.camera;
    this.camera.position = add(focus, turned(subtract(position, focus)));
    this.camera.view_up = unit(turned(before));
  }

  /** Shift the picture by screen pixels. */
  pan(dx, dy) {
    const { camera } = this;
    const [right, up] = this.axes();
    const distance = length(subtract(camera.position, camera.focal_point));
    const half = camera.parallel_scale || distance * Math.tan((camera.view_angle * Math.PI) / 360);
    const perPx = (2 * half) / (this.canvas.clientHeight || 1);
    const shift = add(scale(right, -dx * perPx), scale(up, dy * perPx));
    camera.position = add(camera.position, shift);
    camera.focal_point = add(camera.focal_point, shift);
  }

  /** Come nearer (factor below 1) or go away, within the limits; who is beyond them may come back. */
  dolly(wanted) {
    const { camera } = this;
    const offset = subtract(camera.position, camera.focal_point);
    const factor = this.within(wanted, camera.parallel_scale || length(offset));
    camera.position = add(camera.focal_point, scale(offset, factor));
    if (camera.parallel_scale) camera.parallel_scale *= factor;
  }

  /** The part of a factor that the limits leave. */
  within(factor, now) {
    const home = this.home();
    if (!home) return factor;
    const unit = home.parallel_scale || length(subtract(home.position, home.focal_point));
    const [nearest, farthest] = this.limits().map((share) => share * unit);
    return Math.min(Math.max(factor, Math.min(1, nearest / now)), Math.max(1, farthest / now));
  }

  /** Look as at first. */
  reset() {
    this.camera = this.home();
    this.changed(true);
  }

  wheel(event) {
    if (!this.zooms(event)) return;
    event.preventDefault();
    if (!this.camera) return;
    this.dolly(Math.exp(event.deltaY * DOLLY_PER_PX));
    this.changed(false);
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.changed(true), SETTLE_MS);
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || !this.camera) return;
    const act = {
      r: () => (this.camera = this.home()),
      0: () => (this.camera = this.home()),
      ArrowLeft: () => this.turn(TURN, 0),
      ArrowRight: () => this.turn(-TURN, 0),
      ArrowUp: () => this.turn(0, TURN),
      ArrowDown: () => this.turn(0, -TURN),
    }[event.key];
    if (!act) return;
    event.preventDefault();
    event.stopPropagation();
    act();
    this.changed(true);
  }

  dispose() {
    clearTimeout(this.timer);
  }
}
