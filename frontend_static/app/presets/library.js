import { rest } from "../session/rest.js";

const RETRY_MS = 5000;

/**
 * The saved documents of one kind, as the server keeps them: the list that a search finds, and the one that is looked at.
 *
 * A change names the ETag of what the page shows, so that nobody's work is lost; a refusal of 412 says what others changed.
 * Events: `list`, `chosen` (another one, or a newer state of it), `problem`.
 */
export class Library extends EventTarget {
  #search = "";
  #tag = "";
  #asked = 0;
  #turn = Promise.resolve();
  #own = new Map(); // which ETag a change of this page made of which

  /** @param {"presets"|"actuators"} kind @param {import("../session/live_session.js").LiveSession} session */
  constructor(kind, session) {
    super();
    this.kind = kind;
    this.noun = kind.slice(0, -1);
    this.session = session;
    this.lines = [];
    this.chosen = null;
    this.showsArchive = false;
    this.problem = "";
    this.isLoaded = false;
  }

  /** Read the list anew, and what is looked at if somebody changed it. */
  async refresh() {
    const asked = (this.#asked += 1);
    const query = new URLSearchParams({ search: this.#search, tag: this.#tag, archived: this.showsArchive });
    try {
      const lines = await rest("GET", `/api/${this.kind}?${query}`);
      if (asked !== this.#asked) return;
      this.lines = lines;
      this.isLoaded = true;
      this.#say("");
    } catch (refusal) {
      if (asked === this.#asked) setTimeout(() => asked === this.#asked && this.refresh(), RETRY_MS);
      return this.#say(refusal.message);
    }
    this.dispatchEvent(new Event("list"));
    const line = this.chosen && this.lines.find(({ name }) => name === this.chosen.name);
    if (line && line.etag !== this.chosen.etag) await this.choose(line.name);
  }

  find(search, tag = "") {
    [this.#search, this.#tag] = [search, tag];
    return this.refresh();
  }

  showArchive(isShown) {
    this.showsArchive = isShown;
    return this.refresh();
  }

  /** Look at one of them. @param {string|null} name */
  async choose(name, version) {
    try {
      this.#take(name === null ? null : await rest("GET", this.#path(name, version ? `?version=${version}` : "")));
    } catch (refusal) {
      this.#take(null);
      this.#say(refusal.message);
    }
  }

  /** @returns {Promise<object>} what leads to a version @param {"live"|string|number} against */
  difference(name, version, against) {
    return rest("GET", this.#path(name, `/difference?${new URLSearchParams({ version, against })}`));
  }

  calibration(name, version) {
    return rest("GET", this.#path(name, `/calibration?version=${version}`));
  }

  /** Save the content, or what runs without one, as a new version; `etag` of what it replaces. @throws {Refusal} */
  save(name, body, etag) {
    return this.#change("PUT", this.#path(name), etag, body);
  }

  /** Change what is said about the one that is looked at. @throws {Refusal} */
  edit(changes, etag) {
    return this.#change("PATCH", this.#path(this.chosen.name), etag, changes);
  }

  restore(number, etag) {
    return this.#change("POST", this.#path(this.chosen.name, `/versions/${number}/restore`), etag);
  }

  exportAddress(name) {
    return name === undefined ? `/api/${this.kind}-export` : this.#path(name, "/export");
  }

  /** @returns {Promise<object>} what a file holds; kept unless it is only looked at */
  async take(file, name, isLook) {
    const query = new URLSearchParams({ dry_run: isLook, ...(name ? { name } : {}) });
    const answer = await rest("POST", `/api/${this.kind}/import?${query}`, file);
    if (!isLook) await this.refresh();
    return answer;
  }

  /** One change after the other: the page's own change before this one is no reason to refuse it. */
  #change(method, path, etag, body) {
    const turn = this.#turn.then(async () => {
      let known = etag;
      while (this.#own.has(known)) known = this.#own.get(known);
      const found = await rest(method, path, body, undefined, known ? { "If-Match": known } : {});
      if (known && found.etag !== known) this.#own.set(known, found.etag);
      this.#take(found);
      this.refresh();
      return found;
    });
    this.#turn = turn.catch(() => null);
    return turn;
  }

  #take(found) {
    this.chosen = found;
    this.dispatchEvent(new Event("chosen"));
  }

  #say(problem) {
    this.problem = problem;
    this.dispatchEvent(new Event("problem"));
  }

  #path(name, rest = "") {
    return `/api/${this.kind}/${encodeURIComponent(name)}${rest}`;
  }
}
