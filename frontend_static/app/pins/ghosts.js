import { firstAtOrAfter } from "../session/telemetry_store.js";

const DASHES = [
  [6, 3],
  [2, 2],
  [9, 3, 2, 3],
  [4, 2, 1, 2, 1, 2],
];
const ALPHA = 0.5;
const MOST_COPIES = 30;

/**
 * The shown pinned runs as overlays of the live charts (plots/overlay_lines.js): shifted by whole periods of their reference,
 * as often as the window needs; without a period they stand where they were, counted from the begin of their run.
 */
export class Ghosts {
  /** @param {import("./pinned_runs.js").PinnedRuns} runs @param {import("../plots/time_window.js").TimeWindow} timeWindow */
  constructor(runs, timeWindow) {
    this.runs = runs;
    this.timeWindow = timeWindow;
  }

  get version() {
    return this.runs.version;
  }

  /** @returns {object[]} overlays for the span that is shown */
  get lines() {
    const shown = this.runs.list.filter(({ excerpt, samples }) => excerpt.shown && samples.time.length > 1);
    return shown.flatMap((run) => copies(run, this.timeWindow.range));
  }
}

/** @returns {number[]} how the lines of a pinned run are dashed */
export function dashOf({ id }) {
  return DASHES[(id - 1) % DASHES.length];
}

function copies(run, [from, to]) {
  const { samples, excerpt } = run;
  const period = excerpt.period_s;
  if (!period) return [ghost(run, 0, 0, Infinity)];
  const periods = Math.floor(run.seconds / period + 1e-9);
  const last = period * Math.ceil((to - samples.time.at(-1)) / period - 1e-9);
  const lines = [ghost(run, 0, last, Infinity)];
  const length = periods * period;
  // Each earlier copy ends where the next one begins.
  for (let shift = last - length; periods > 0 && samples.time[0] + shift + length > from && lines.length < MOST_COPIES; shift -= length)
    lines.push(ghost(run, lines.length, shift, samples.time[0] + length));
  return lines;
}

function ghost(run, copy, shift, until) {
  const { samples } = run;
  const end = until === Infinity ? samples.time.length : firstAtOrAfter(samples.time, until);
  return {
    key: `pin ${run.id}.${copy}`,
    label: run.excerpt.label,
    dash: dashOf(run),
    alpha: ALPHA,
    shift,
    isSilent: true,
    picture: () =>
      end === samples.time.length
        ? samples
        : { time: samples.time.subarray(0, end), column: (name) => samples.column(name).subarray(0, end) },
  };
}
