// The eye: it goes round a point, z stays up. One finger or the left button
// turns, two fingers or another button move, pinch and wheel come nearer.

import { add, cross, lookingAt, normalised, perspective, product, projected, scaled, subtract } from "./vectors.js";

const ANGLE = (32 * Math.PI) / 180;
const STEEPEST = 1.55;
// Movements in pixels up to which a press is a click.
const CLICK = 5;

export class Camera {
  constructor() {
    this.azimuth = -1.05;
    this.elevation = 0.34;
    this.distance = 1;
    this.target = [0, 0, 0.1];
    this.reach = 0.3;
    this.moved = false;
    this.size = [1, 1];
    // Parts of the picture, from 0 to 1, that panels cover.
    this.covered = { right: 0, top: 0, bottom: 0 };
  }

  // Sees an upright cylinder about a centre whole: its radius and half its height.
  fit(centre, radius, half) {
    const [width, height] = this.size, { right, top, bottom } = this.covered;
    const tan = Math.tan(ANGLE / 2), margin = 1.06;
    const up = half * Math.cos(this.elevation) + radius * Math.abs(Math.sin(this.elevation));
    const high = up / (tan * (1 - top - bottom)), wide = (radius * height) / (tan * width * (1 - right));
    this.target = centre.slice();
    this.reach = Math.hypot(radius, half);
    this.distance = margin * Math.max(high, wide) + radius;
    this.moved = false;
  }

  // How far the middle of the free part of the picture is above its middle.
  get raised() {
    return this.covered.bottom - this.covered.top;
  }

  get back() {
    const flat = Math.cos(this.elevation);
    return [flat * Math.cos(this.azimuth), flat * Math.sin(this.azimuth), Math.sin(this.elevation)];
  }

  get eye() {
    return add(this.target, scaled(this.back, this.distance));
  }

  get matrix() {
    const near = Math.max(this.distance - 6 * this.reach, this.distance / 60);
    const lens = perspective(ANGLE, this.size[0] / this.size[1], near, this.distance + 8 * this.reach);
    // The middle of the free part of the picture is the middle of the view.
    lens[8] += this.covered.right;
    lens[9] -= this.raised;
    return product(lens, lookingAt(this.eye, this.target, [0, 0, 1]));
  }

  // Where a point is seen, in pixels of the page.
  onScreen(point) {
    const [x, y] = projected(this.matrix, point);
    return [((x + 1) / 2) * this.size[0], ((1 - y) / 2) * this.size[1]];
  }

  // The line of sight through a pixel: where it begins and whereto it goes.
  ray(x, y) {
    const tan = Math.tan(ANGLE / 2), aspect = this.size[0] / this.size[1];
    const right = normalised(cross([0, 0, 1], this.back)), above = cross(this.back, right);
    const across = ((2 * x) / this.size[0] - 1 + this.covered.right) * tan * aspect;
    const up = (1 - (2 * y) / this.size[1] - this.raised) * tan;
    const direction = normalised(subtract(add(scaled(right, across), scaled(above, up)), this.back));
    return [this.eye, direction];
  }

  turn(dx, dy) {
    this.azimuth -= dx * 0.008;
    this.elevation = Math.min(Math.max(this.elevation + dy * 0.008, -STEEPEST), STEEPEST);
    this.moved = true;
  }

  shift(dx, dy) {
    const pixel = (2 * this.distance * Math.tan(ANGLE / 2)) / this.size[1];
    const right = normalised(cross([0, 0, 1], this.back)), above = cross(this.back, right);
    this.target = add(this.target, add(scaled(right, -dx * pixel), scaled(above, dy * pixel)));
    this.moved = true;
  }

  zoom(factor) {
    this.distance = Math.min(Math.max(this.distance * factor, this.reach / 20), this.reach * 20);
    this.moved = true;
  }

  // Listens on an element; `changed` after each movement, `clicked` with a place.
  listen(element, changed, clicked) {
    const fingers = new Map();
    let travelled = 0;
    const spread = () => {
      const [a, b] = [...fingers.values()];
      return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.hypot(a.x - b.x, a.y - b.y) };
    };
    element.addEventListener("pointerdown", (event) => {
      element.setPointerCapture(event.pointerId);
      if (fingers.size === 0) travelled = 0;
      fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    element.addEventListener("pointermove", (event) => {
      const finger = fingers.get(event.pointerId);
      if (!finger) return;
      const before = fingers.size === 2 ? spread() : null;
      const dx = event.clientX - finger.x, dy = event.clientY - finger.y;
      [finger.x, finger.y] = [event.clientX, event.clientY];
      travelled += Math.abs(dx) + Math.abs(dy);
      if (before) {
        const now = spread();
        this.shift(now.x - before.x, now.y - before.y);
        this.zoom(before.apart / Math.max(now.apart, 1));
        travelled += CLICK + 1;
      } else if (event.buttons > 1 || event.shiftKey) this.shift(dx, dy);
      else if (travelled > CLICK) this.turn(dx, dy);
      changed();
    });
    const up = (event) => {
      const known = fingers.delete(event.pointerId);
      const click = known && event.type === "pointerup" && event.button === 0;
      if (click && fingers.size === 0 && travelled <= CLICK) {
        const box = element.getBoundingClientRect();
        clicked(event.clientX - box.left, event.clientY - box.top);
      }
    };
    element.addEventListener("pointerup", up);
    element.addEventListener("pointercancel", up);
    element.addEventListener("contextmenu", (event) => event.preventDefault());
    element.addEventListener("wheel", (event) => {
      event.preventDefault();
      const unit = event.deltaMode === 1 ? 30 : 1;
      this.zoom(Math.exp(Math.min(Math.max(event.deltaY * unit, -300), 300) * 0.0015));
      changed();
    }, { passive: false });
  }
}
