const NEVER = { state: "off", sentence: "Off.", by: "", trigger: null, excerpt: null };

/** The session's one trigger, as the server says it stands. Event `change`; `captured` (detail: the excerpt). */
export class Trigger extends EventTarget {
  constructor(session) {
    super();
    this.session = session;
    this.now = NEVER;
    session.connection.addEventListener("message", ({ detail }) => {
      if (detail.type === "trigger") this.#take(detail);
      if (detail.type === "hello") this.#greet(detail.trigger ?? NEVER);
    });
    session.addEventListener("connection", () => this.dispatchEvent(new Event("change")));
  }

  get isWaiting() {
    return this.now.state === "armed" || this.now.state === "fired";
  }

  /** @param {object} asked arguments of arm_trigger @throws {Refusal} */
  arm(asked) {
    return this.session.command("arm_trigger", asked);
  }

  disarm() {
    return this.session.command("disarm_trigger");
  }

  #greet(message) {
    this.now = message;
    this.dispatchEvent(new Event("change"));
  }

  #take(message) {
    this.#greet(message);
    if (message.state === "captured" && message.excerpt) this.dispatchEvent(new CustomEvent("captured", { detail: message }));
  }
}
