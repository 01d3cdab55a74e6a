/**
 * Where the replay of a recording stands, and whether it runs.
 *
 * Event `change`.
 */
export class Replay extends EventTarget {
  static get speeds() {
    return [0.1, 0.25, 0.5, 1, 2, 5, 10];
  }

  constructor() {
    super();
    this.extent = [0, 0];
    this.position = 0;
    this.speed = 1;
    this.isPlaying = false;
  }

  /** Replay another span of time, from its begin. */
  open(extent) {
    this.isPlaying = false;
    this.extent = extent;
    this.seek(extent[0]);
  }

  /** The same recording has grown. */
  grow(extent) {
    this.extent = extent;
    this.dispatchEvent(new Event("change"));
  }

  seek(time) {
    this.position = Math.max(this.extent[0], Math.min(this.extent[1], time));
    this.dispatchEvent(new Event("change"));
  }

  toggle() {
    if (this.isPlaying) return this.pause();
    if (this.position >= this.extent[1]) this.position = this.extent[0];
    this.isPlaying = true;
    this.before = null;
    requestAnimationFrame((now) => this.#frame(now));
    this.dispatchEvent(new Event("change"));
  }

  pause() {
    this.isPlaying = false;
    this.dispatchEvent(new Event("change"));
  }

  #frame(now) {
    if (!this.isPlaying) return;
    const passed = this.before === null ? 0 : ((now - this.before) / 1000) * this.speed;
    this.before = now;
    if (this.position + passed >= this.extent[1]) this.isPlaying = false;
    this.seek(this.position + passed);
    requestAnimationFrame((next) => this.#frame(next));
  }
}
