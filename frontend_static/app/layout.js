/**
 * The one hand-made list of what stands in the parameter column: order, grouping and visibility. All else about a
 * parameter comes from the server's schema.
 *
 * `part` is a path of the Scenario document. `kinds` are the alternatives offered for it, each with its fields in order;
 * without `kinds` the part has one shape. `when` hides a field that has no effect at present; `short` is a shorter name
 * where the panel's title says the rest.
 */
export const PANELS = [
  { id: "scenario", title: "Scenario", is: "scenario" },
  { id: "preset", title: "Preset", is: "preset" },
  {
    id: "stiffness",
    title: "Stiffness",
    part: "stiffness_reference",
    kinds: [{ kind: "constant", label: "Constant", fields: ["stiffness"] }],
  },
  {
    id: "controller",
    title: "Controller",
    part: "tuning.controller",
    kinds: [
      { kind: "state_feedback", label: "State feedback", fields: ["natural_frequency", "damping"] },
      {
        kind: "sliding_mode",
        label: "Sliding mode",
        fields: [
          "surface_pole",
          "switching_gain",
          "switch",
          { name: "layer_width", when: (now) => now.switch === "layer" },
        ],
      },
    ],
  },
  {
    id: "observer",
    title: "Observer",
    part: "tuning.observer",
    kinds: [
      {
        kind: "velocity",
        label: "Velocity",
        fields: [
          "bandwidth",
          "discretisation",
          "velocity_source",
          { name: "velocity_filter", when: (now) => now.velocity_source === "difference" },
        ],
      },
      { kind: "position", label: "Position", fields: ["bandwidth"] },
    ],
  },
  {
    id: "reference",
    title: "Reference",
    part: "reference",
    kinds: [
      { kind: "sine", label: "Sine", fields: ["amplitude", "frequency_hz", "offset", "fade_in_s"] },
      { kind: "move", label: "Move", fields: ["origin", "target", "duration_s", "dwell_s", "repeat", "start_s"] },
      { kind: "step", label: "Step", fields: ["origin", "target", "dwell_s", "repeat", "start_s"] },
    ],
  },
  {
    id: "disturbance",
    title: "Disturbance",
    is: "disturbance",
    part: "disturbances",
    terms: [
      { kind: "constant", fields: ["torque"] },
      { kind: "sine", fields: ["amplitude", "frequency_hz"] },
    ],
  },
  {
    id: "stiffness-loop",
    title: "Stiffness loop",
    part: "tuning.stiffness_loop",
    fields: [
      { name: "bandwidth", short: "bandwidth" },
      { name: "damping", short: "damping" },
      { name: "observer_bandwidth", short: "observer" },
      { name: "reference_bandwidth", short: "reference filter" },
      { name: "torque_reserve", short: "torque reserve" },
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
];

/** Words for the values of choice fields; a value without one is shown as it is. */
export const CHOICE_WORDS = {
  layer: "layer",
  sgn: "sgn",
  exact: "exact",
  first_order_hold: "first-order hold",
  measured: "measured",
  difference: "difference",
  true: "yes",
  false: "no",
};
