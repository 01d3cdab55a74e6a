import { briefly } from "./quantity.js";

/**
 * The one hand-made list of what stands in the parameter column: order, grouping and visibility. All else about a
 * parameter comes from the server's schema.
 *
 * `part` is a path of the Scenario document. `kinds` are the alternatives offered for it, each with its fields in order;
 * without `kinds` the part has one shape. `when` hides a field that has no effect at present: it gets the part and the
 * whole scenario. `short` is a shorter name where the panel's title or a heading says the rest. `beside` joins a second
 * list of the same length. What a layout leaves out of a part follows its listed fields.
 */
const is = (name, ...values) => (now) => values.includes(now[name]);
const lacksVelocity = (now) => now.velocity_source === "difference";
const isDelayed = (now, scenario) => scenario.timing.compute_delay_samples > 0;

const POLES = [
  { name: "natural_frequency", when: is("design", "poles") },
  { name: "damping", when: is("design", "poles") },
];
const PLANT_WEIGHTS = [
  { heading: "Weights on the plant’s state", when: is("design", "lqr_plant") },
  { name: "link_position_weight", short: "link", when: is("design", "lqr_plant") },
  { name: "link_velocity_weight", short: "link speed", when: is("design", "lqr_plant") },
  { name: "motor_position_weight", short: "motor", when: is("design", "lqr_plant") },
  { name: "motor_velocity_weight", short: "motor speed", when: is("design", "lqr_plant") },
  { name: "torque_weight", short: "torque", when: is("design", "lqr_plant") },
];
const CHAIN_WEIGHTS = [
  { heading: "Weights on the error", when: is("design", "lqr_chain") },
  { name: "error_weight", short: "error", when: is("design", "lqr_chain") },
  { name: "error_velocity_weight", short: "velocity", when: is("design", "lqr_chain") },
  { name: "error_acceleration_weight", short: "acceleration", when: is("design", "lqr_chain") },
  { name: "error_jerk_weight", short: "jerk", when: is("design", "lqr_chain") },
  { name: "snap_weight", short: "snap", when: is("design", "lqr_chain") },
];
const VELOCITIES = ["velocity_source", { name: "velocity_filter", when: lacksVelocity }];
const PREDICT = { name: "predict", short: "predict delay", when: isDelayed };
const TIMES = ["start_s", "end_s"];
const DWELL = [{ name: "dwell_s", when: is("repeat", true) }, "repeat", "start_s"];

export const PANELS = [
  { id: "scenario", title: "Scenario", is: "scenario" },
  { id: "preset", title: "Preset", is: "preset" },
  {
    id: "stiffness",
    title: "Stiffness",
    part: "stiffness_reference",
    kinds: [
      { kind: "constant", label: "Constant", fields: ["stiffness"] },
      {
        kind: "move",
        label: "Move",
        fields: [
          { name: "stiffness", short: "before" },
          { name: "target", short: "after" },
          "start_s",
          "duration_s",
        ],
      },
    ],
  },
  {
    id: "controller",
    title: "Controller",
    part: "tuning.controller",
    kinds: [
      {
        kind: "state_feedback",
        label: "State feedback",
        fields: ["design", ...POLES, ...CHAIN_WEIGHTS, ...PLANT_WEIGHTS, "sampled"],
      },
      {
        kind: "sliding_mode",
        label: "Sliding mode",
        fields: [
          "switch",
          "surface_pole",
          { name: "switching_gain", when: is("switch", "layer", "tanh", "sgn") },
          { name: "layer_width", when: is("switch", "layer", "tanh") },
          { name: "twisting_gain", when: is("switch", "super_twisting") },
        ],
      },
      { kind: "baseline", label: "Baseline", fields: ["design", ...POLES, ...PLANT_WEIGHTS] },
    ],
  },
  {
    id: "observer",
    title: "Observer",
    part: "tuning.observer",
    kinds: [
      { kind: "off", label: "Off", fields: [...VELOCITIES, PREDICT] },
      {
        kind: "velocity",
        label: "Velocity",
        fields: ["bandwidth", "shape", "discretisation", ...VELOCITIES, PREDICT],
      },
      { kind: "position", label: "Position", fields: ["bandwidth", "shape", PREDICT] },
    ],
  },
  {
    id: "schedule",
    title: "Gains that follow the stiffness",
    part: "tuning.schedule",
    isCollapsed: true,
    fields: [
      { name: "poles_exponent", short: "poles" },
      { name: "bandwidth_exponent", short: "bandwidth" },
      { name: "reference_stiffness", when: (now) => now.poles_exponent !== 0 || now.bandwidth_exponent !== 0 },
    ],
  },
  {
    id: "reference",
    title: "Reference",
    part: "reference",
    columns: 4,
    kinds: [
      { kind: "step", label: "Step", fields: ["origin", "target", ...DWELL] },
      { kind: "move", label: "Move", fields: ["origin", "target", "duration_s", ...DWELL] },
      { kind: "sine", label: "Sine", fields: ["amplitude", "frequency_hz", "offset", "fade_in_s"] },
      { kind: "chirp", label: "Chirp", fields: ["amplitude", "start_frequency_hz", "end_frequency_hz", "duration_s"] },
      { kind: "filtered_step", label: "Filtered", fields: ["origin", "target", "bandwidth", ...DWELL] },
      { kind: "multisine", label: "Multisine", fields: ["components"] },
      {
        kind: "jog",
        label: "Jog",
        fields: [
          "velocity",
          "distance",
          "duration_s",
          { name: "acceleration", short: "acceleration" },
          { name: "jerk", short: "jerk" },
          { name: "snap", short: "snap" },
        ],
      },
      { kind: "recorded", label: "Recorded", fields: [{ name: "times_s", beside: "positions", short: "samples" }] },
    ],
  },
  {
    id: "disturbance",
    title: "Disturbance",
    is: "disturbance",
    part: "disturbances",
    sides: [
      { value: "link", text: "Link" },
      { value: "motor", text: "Motor" },
      { value: "stiffness_motor", text: "Stiffness", torqueShare: 0.02 },
    ],
    /* `main` is the amount on the term's own line where the kind `isQuick`: it is always there. `says` sums up the rest. */
    terms: [
      {
        kind: "constant",
        label: "Constant",
        isQuick: true,
        main: "torque",
        fields: TIMES,
        says: (now) => [torque(now.torque)],
      },
      {
        kind: "sine",
        label: "Sine",
        isQuick: true,
        main: "amplitude",
        fields: ["frequency_hz", "phase", ...TIMES],
        says: (now) => [torque(now.amplitude), `${briefly(now.frequency_hz)} Hz`],
      },
      {
        kind: "multisine",
        label: "Multisine",
        fields: ["components", ...TIMES],
        says: (now) => [`${now.components.length} sine${now.components.length === 1 ? "" : "s"}`],
      },
      {
        kind: "chirp",
        label: "Chirp",
        beginsNow: true,
        fields: ["amplitude", "start_frequency_hz", "end_frequency_hz", "duration_s", "sweep", ...TIMES],
        says: (now) => [
          torque(now.amplitude),
          `${briefly(now.start_frequency_hz)} to ${briefly(now.end_frequency_hz)} Hz`,
        ],
      },
      {
        kind: "noise",
        label: "Noise",
        fields: ["rms", { name: "bandwidth_hz", short: "bandwidth" }, ...TIMES],
        says: (now) => [`${torque(now.rms)} rms`, `${briefly(now.bandwidth_hz)} Hz`],
      },
      {
        kind: "pulse",
        label: "Pulse",
        beginsNow: true,
        fields: ["torque", "width_s", "repeat", { name: "period_s", when: is("repeat", true) }, ...TIMES],
        says: (now) => [
          torque(now.torque),
          now.repeat ? `every ${briefly(now.period_s)} s` : `${briefly(now.width_s)} s long`,
        ],
      },
      {
        kind: "pendulum",
        label: "Pendulum",
        fields: ["mass", "length", ...TIMES],
        says: (now) => [`${briefly(now.mass)} kg at ${briefly(now.length)} m`],
      },
      {
        kind: "contact",
        label: "Contact",
        fields: ["position", "side", "stiffness", "damping", ...TIMES],
        says: (now) => [`wall ${now.side} ${briefly(now.position)} rad`],
      },
    ],
  },
  { id: "sequence", title: "Sequence", is: "sequence", isCollapsed: true },
  {
    id: "stiffness-loop",
    title: "Stiffness loop",
    part: "tuning.stiffness_loop",
    isCollapsed: true,
    fields: [
      { name: "bandwidth", short: "bandwidth" },
      { name: "damping", short: "damping" },
      { name: "observer_bandwidth", short: "observer" },
      { name: "reference_bandwidth", short: "reference filter" },
      { name: "torque_reserve", short: "torque reserve" },
      { name: "terms", short: "terms known" },
    ],
  },
  {
    id: "model",
    title: "Controller’s model",
    hint: "What the controller believes, not the plant: differ on purpose to test robustness.",
    part: "tuning.model",
    isCollapsed: true,
    fields: [
      "link_inertia",
      "link_damping",
      "motor_inertia",
      "motor_damping",
      "spring_constant",
      { name: "stiffness_inertia", short: "screw inertia" },
      { name: "stiffness_damping", short: "screw damping" },
    ],
  },
  {
    id: "rig",
    title: "Rig and sensors",
    hint: "The plant as it truly is; the controller is not told. Each change here restarts at t = 0.",
    is: "grouped",
    isCollapsed: true,
    groups: [
      { title: "Link", part: "actuator.link", fields: [] },
      {
        title: "Motor",
        part: "actuator.motor",
        fields: [
          "inertia",
          "damping",
          { name: "coulomb_friction", short: "dry friction" },
          { name: "friction_velocity", short: "smoothing" },
          { name: "torque_lag_s", short: "torque lag" },
          "torque_delay_s",
          "peak_torque",
          { name: "continuous_torque", short: "continuous" },
        ],
      },
      {
        title: "Sensors",
        part: "sensors",
        fields: [
          "link_bits",
          "motor_counts",
          { name: "stiffness_counts", short: "screw encoder" },
          { name: "velocities", short: "velocities" },
          { name: "link_noise", short: "link noise" },
          { name: "motor_noise", short: "motor noise" },
          { name: "stiffness_noise", short: "screw noise" },
          { name: "velocity_noise", when: (now) => now.velocities },
        ],
      },
      {
        title: "Control computer",
        part: "timing",
        fields: ["sample_time_s", { name: "compute_delay_samples", words: { 0: "none", 1: "one sample" } }],
      },
      {
        title: "Spring and stiffness motor",
        part: "actuator.stiffness",
        fields: [
          "spring_constant",
          { name: "inertia", short: "inertia" },
          { name: "damping", short: "damping" },
          { name: "softest", short: "softest" },
          { name: "stiffest", short: "stiffest" },
          { name: "peak_torque", short: "peak" },
          { name: "continuous_torque", short: "rms" },
          { name: "speed_limit", short: "speed limit" },
          { name: "leaf_torque", short: "leaf limit" },
          { name: "back_torque", short: "back torque" },
        ],
      },
      { title: "Start", part: "initial", fields: [] },
      { title: "Chance", part: "", fields: ["seed"], isPartial: true },
    ],
  },
];

/** Words for the values of choice fields; a value without one is shown as it is. */
export const CHOICE_WORDS = {
  lqr_chain: "LQR chain",
  lqr_plant: "LQR plant",
  super_twisting: "twisting",
  butterworth: "Butterworth",
  kalman: "Kalman",
  first_order_hold: "first-order hold",
  logarithmic: "log",
  true: "yes",
  false: "no",
};

function torque(value) {
  return `${briefly(value)} N·m`;
}
