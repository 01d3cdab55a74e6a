import { element } from "../element.js";
import { compact, fixed } from "../quantity.js";

/** The worst plant of a box, in words and figures, and whether the nonlinear simulation agrees. */
export class WorstCaseSection {
  constructor(axes) {
    this.axes = axes;
    this.body = element("div", { class: "worst-case" });
    this.empty = element("p", { class: "result-overlay" }, "No worst case yet. Choose a box on the left, and search.");
    this.root = element(
      "div",
      { class: "result-section result-scrolls", tabindex: "0", role: "group", "aria-label": "Worst case" },
      this.body,
      this.empty,
    );
  }

  take(result, asked) {
    this.empty.hidden = true;
    const { stable, growth, disk, certificate, note, evaluations, plant, stiffness } = result;
    const verdict = stable
      ? `Stable everywhere it looked. At the worst plant the disk margin is ${fixed(disk, 2)}, and the slowest mode decays at ${compact(-growth)} 1/s.`
      : `Unstable inside the box: at the worst plant errors grow at ${compact(growth)} 1/s.`;
    const where = `Around the loop at ${compact(stiffness)} N·m/rad on ${plant === "model" ? "its model" : "the actuator"}; ${evaluations} plants were tried, so a narrower valley may be missed.`;
    this.body.replaceChildren(
      element("p", { class: "worst-verdict", "data-tone": stable ? "good" : "fault" }, verdict),
      element("h3", {}, "The worst plant"),
      this.#table(result.values, asked?.box),
      ...(certificate ? certified(certificate) : []),
      element("p", { class: "hint" }, `${where}${note ? ` Note: ${note}.` : ""}`),
    );
  }

  #table(values, box) {
    const lines = Object.entries(values).map(([name, value]) => {
      const axis = this.axes.find((each) => each.name === name);
      const unit = axis.shownUnit || "";
      const range = box?.[name] ? `${box[name].map((each) => compact(each * axis.factor)).join(" to ")} ${unit}` : "";
      return element(
        "tr",
        {},
        element("th", { scope: "row" }, axis.label),
        element("td", {}, `${unit ? "" : "×"}${compact(value * axis.factor)} ${unit}`),
        element("td", { class: "hint" }, range),
      );
    });
    return element(
      "table",
      {},
      element("thead", {}, element("tr", {}, ...["parameter", "worst at", "looked at"].map((text) => element("th", { scope: "col" }, text)))),
      element("tbody", {}, ...lines),
    );
  }
}

/** A decay too fast or too slow to be seen is no disagreement. */
function verdictOf({ agreed, seen_stable, reason }) {
  if (agreed) return { tone: "good", words: `Agreed: ${reason}.` };
  if (seen_stable === null) return { tone: "none", words: `The simulation gives no verdict: ${reason}.` };
  return { tone: "warning", words: `Not agreed: ${reason}.` };
}

function angle(radians) {
  const [factor, unit] = radians < 1e-6 ? [1e9, "nrad"] : radians < 1e-3 ? [1e6, "µrad"] : [1e3, "mrad"];
  return `${compact(radians * factor)} ${unit}`;
}

function certified({ agreed, seen_stable, reason, predicted_growth, seen_growth, duration_s, peak_error, ending }) {
  const { tone, words } = verdictOf({ agreed, seen_stable, reason });
  const rate = (value) => (value === null ? "none to see" : `${compact(value)} 1/s`);
  return [
    element("h3", {}, "Simulated there, with the nonlinear spring"),
    element("p", { class: "worst-verdict", "data-tone": tone }, words),
    element(
      "table",
      {},
      element(
        "tbody",
        {},
        ...[
          ["predicted growth", rate(predicted_growth)],
          ["seen growth", rate(seen_growth)],
          ["simulated", `${compact(duration_s)} s${ending ? `, ended: ${ending}` : ""}`],
          ["largest link error", angle(peak_error)],
        ].map(([name, figure]) => element("tr", {}, element("th", { scope: "row" }, name), element("td", {}, figure))),
      ),
    ),
  ];
}
