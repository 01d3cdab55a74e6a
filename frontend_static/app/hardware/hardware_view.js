import { element } from "../element.js";
import { LiveSource } from "../plots/live_source.js";
import { PlotStack } from "../plots/plot_stack.js";
import { PlotToolbar } from "../plots/plot_toolbar.js";
import { PlotsOverlay } from "../plots/plots_overlay.js";
import { ArmPanel } from "./arm_panel.js";
import { BusPanel } from "./bus_panel.js";
import { DisplayChoices } from "./display_choices.js";
import { DisplayTools } from "./display_tools.js";
import { DrivePanel } from "./drive_panel.js";
import { FaultPanel } from "./fault_panel.js";
import { FaultSnapshots } from "./fault_snapshots.js";
import { FollowPanel } from "./follow_panel.js";
import { GoToPanel } from "./go_to_panel.js";
import { hardwareCharts } from "./hardware_charts.js";
import { HomingPanel } from "./homing_panel.js";
import { JogPad } from "./jog_pad.js";
import { NextStepLine } from "./next_step_line.js";
import { RigList } from "./rig_list.js";
import { Rigs } from "./rigs.js";
import { StiffnessPanel } from "./stiffness_panel.js";
import { TryPanel } from "./try_panel.js";

const VIEW = "hardware";

/** The view Hardware: to the rig on the left, its signals in the middle, its motion on the right, its health beneath. */
export class HardwareView {
  #layouts = "";

  /** @param {HTMLElement} root
   *  @param {object} desk {session, operator, jog, actions, tryFirst, theme, views, pins, openRecording} */
  constructor(root, desk) {
    this.desk = { ...desk, choices: new DisplayChoices(), rigs: new Rigs() };
    const { session, operator, views, theme } = desk;
    const { choices, rigs } = this.desk;
    this.toolbarArea = element("div", { class: "plot-toolbar", role: "toolbar", "aria-label": "Plots of the rig" });
    this.charts = element("div", { class: "recorded-charts" });
    const overlay = element("p", { class: "plots-overlay", role: "status" });
    this.stack = new PlotStack(this.charts, new LiveSource(session), theme, hardwareCharts(choices, operator.rig));
    this.toolbar = new PlotToolbar(this.toolbarArea, this.stack);
    this.toolbarArea.append(new DisplayTools(this.desk).root);
    new PlotsOverlay(overlay, session);
    root.append(
      new NextStepLine(this.desk).root,
      this.#area("rig-left", "To the rig", RigList, HomingPanel, ArmPanel, TryPanel),
      element("section", { class: "rig-plots", "aria-label": "Plots of the rig" }, this.toolbarArea, this.charts, overlay),
      this.#area("rig-right", "Motion", JogPad, GoToPanel, FollowPanel, StiffnessPanel),
      this.#area("rig-foot", "Health", DrivePanel, BusPanel, FaultPanel, FaultSnapshots),
    );
    for (const source of [operator, choices]) source.addEventListener("change", () => this.#chart());
    for (const source of [session, views]) source.addEventListener(source === session ? "hello" : "change", () => views.shown === VIEW && rigs.refresh());
    if (views.shown === VIEW) rigs.refresh();
  }

  get isShown() {
    return this.desk.views.shown === VIEW;
  }

  #area(name, label, ...panels) {
    return element("div", { class: name, tabindex: "0", role: "group", "aria-label": label }, ...panels.map((Panel) => new Panel(this.desk).root));
  }

  /** Other charts only when units or limits are others: they begin with fresh scales. */
  #chart() {
    const layouts = hardwareCharts(this.desk.choices, this.desk.operator.rig);
    const text = JSON.stringify(layouts);
    if (text === this.#layouts) return;
    this.#layouts = text;
    this.stack.show(layouts);
  }
}
