import { OpenRecording } from "./open_recording.js";
import { RecordingList } from "./recording_list.js";

const VIEW = "recordings";

/** The view Recordings: the list of all, or one that is open; its address is #recordings/<id>. */
export class RecordingsView {
  #overlays = [];
  #shown = null; // id of what is open

  /** @param {HTMLElement} root @param {object} desk {session, theme, views} */
  constructor(root, desk) {
    this.views = desk.views;
    this.list = new RecordingList(desk.session, (id, overlays) => {
      this.#overlays = overlays;
      this.views.go(VIEW, id);
    });
    this.page = new OpenRecording(desk, () => this.views.go(VIEW, ""));
    root.append(this.list.root, this.page.root);
    this.views.addEventListener("change", () => this.#look());
    this.#look();
  }

  /** Open a recording at a span of it, s. */
  openSpan(id, span, at) {
    this.page.wanted = { id, span, at };
    if (this.#shown === id) this.page.showWanted();
    this.views.go(VIEW, id);
  }

  get isShown() {
    return this.views.shown === VIEW;
  }

  /** Whether a recording is open in this view: then the keys are for it. */
  get isOpen() {
    return this.isShown && this.page.isOpen;
  }

  /** The space bar, where it does not pause the session. @returns {boolean} whether it was for this view */
  takeSpace() {
    if (this.isOpen) this.page.playOrPause();
    return this.isOpen || (this.isShown && this.list.chooseFocused());
  }

  #look() {
    const { isShown } = this;
    const id = isShown ? this.views.path : "";
    if (isShown && id !== (this.#shown ?? "")) {
      this.#shown = id || null;
      if (id) this.page.open(id, this.#overlays);
      else this.page.close();
      this.#overlays = [];
    }
    if (!isShown) this.page.replay.pause();
    this.page.root.hidden = !isShown || !this.#shown;
    this.list.isShown = isShown && !this.#shown;
  }
}
