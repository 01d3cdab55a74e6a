import { setText } from "../element.js";

const WORDS = {
  starting: "Starting",
  ready: "Ready",
  running: "Running",
  paused: "Paused",
  stopped: "Stopped",
  fault: "Fault",
  connected: "Connected",
  homing: "Homing",
  armed: "Armed",
  stopping: "Stopping",
};

/** State dot, state word and sentence: what the session does, and why. */
export class StateLine {
  constructor(session) {
    this.session = session;
    this.line = document.getElementById("state");
    this.word = document.getElementById("state-word");
    this.rest = document.getElementById("state-sentence");
    this.announcement = document.getElementById("announcement");
    session.addEventListener("snapshot", () => this.#show());
    session.addEventListener("connection", () => this.#show());
  }

  #show() {
    const { snapshot, isConnected } = this.session;
    if (!snapshot) return this.#say("connecting", "Connecting", "to the session");
    if (!isConnected) return this.#say("lost", "No connection", "what is shown is old");
    const word = WORDS[snapshot.state] ?? snapshot.state;
    const { sentence } = this.session;
    const rest = sentence.toLowerCase().startsWith(word.toLowerCase())
      ? sentence.slice(word.length).replace(/^[,:.\s]+/, "")
      : sentence;
    this.#say(snapshot.state, word, rest);
  }

  #say(state, word, rest) {
    this.line.dataset.state = state;
    this.line.title = `${word} ${rest}`;
    setText(this.word, word);
    setText(this.rest, rest);
    setText(this.announcement, `${word} ${rest}`);
  }
}
