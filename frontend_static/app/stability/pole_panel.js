import { element } from "../element.js";
import { PolePlot } from "./pole_plot.js";
import { StabilityPanel } from "./stability_panel.js";

/** The poles of the sampled loop in the s-plane. */
export class PolePanel {
  constructor(document) {
    this.document = document;
    this.plot = new PolePlot();
    this.panel = new StabilityPanel("Poles", [this.plot.root], "div");
    this.panel.asideText.replaceChildren(key("dominant"), key("observer"));
    this.root = this.panel.root;
  }

  show({ poles, sample_time_s }) {
    const { kind, bandwidth } = this.document.value("tuning.observer") ?? {};
    this.plot.show(poles, sample_time_s, kind === "off" ? null : (bandwidth ?? null));
  }
}

function key(role) {
  return element("span", { class: `pole-key pole-${role}` }, "×", element("span", {}, role));
}
