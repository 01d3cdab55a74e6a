"use strict";
// Read before viser's client. It leans on inner parts of that client (the messages its worker posts,
// `window.__viserMutable`, retrying only with the focus), so a new version of viser wants a look at the page.
(() => {
  const { exchange, note } = window.vsseaScene;

  // viser reconnects only while the page has the focus; a scene beside the plots seldom has it.
  document.hasFocus = () => true;

  // One server draws for all pages in the dark page's colours; a light page exchanges them as they arrive.
  const recolour = ({ props }) => {
    const other = props?.color && exchange[Array.from(props.color).join(",")];
    if (other) props.color = other;
  };

  // A picture that no longer follows the actuator must not look alive.
  const alive = (yes) => {
    document.documentElement.classList.toggle("lost", !yes);
    const line = document.getElementById("scene-note");
    if (line) line.textContent = yes ? note : "scene lost, connecting again";
  };

  const NativeWorker = window.Worker;
  window.Worker = class extends NativeWorker {
    set onmessage(handler) {
      super.onmessage = (event) => {
        const { type, messages } = event.data;
        if (type === "message_batch") messages.forEach(recolour);
        if (type === "connected" || type === "closed") alive(type === "connected");
        handler(event);
      };
    }
    get onmessage() {
      return super.onmessage;
    }
  };

  // The renderer's filmic tone curve would fade the colours, which are those of the plots: switch it off for good.
  // three.js announces each renderer to developer tools, if there are any.
  window.__THREE_DEVTOOLS__ ??= new EventTarget();
  window.__THREE_DEVTOOLS__.addEventListener("observe", ({ detail }) => {
    if (detail && "toneMapping" in detail) Object.defineProperty(detail, "toneMapping", { get: () => 0, set() {} });
  });

  // viser's point-cloud sorter wants eval, which the page's policy refuses; this scene has nothing to sort.
  window.addEventListener("unhandledrejection", (event) => {
    if (event.reason instanceof EvalError) event.preventDefault();
  });

  // Keys belong to the dashboard: Esc must stop the actuator from here too, and viser's own keys would move the camera.
  const hand = (event) => {
    event.stopImmediatePropagation();
    if (window.parent === window) return;
    const copy = new KeyboardEvent(event.type, event);
    if (!window.parent.document.dispatchEvent(copy)) event.preventDefault();
  };
  for (const kind of ["keydown", "keyup"]) window.addEventListener(kind, hand, true);

  const resetCamera = () => window.__viserMutable?.resetCameraPose?.(true);
  window.addEventListener("dblclick", resetCamera);
  window.addEventListener("message", (event) => {
    if (event.origin === window.location.origin && event.data?.type === "reset-camera") resetCamera();
  });

  window.addEventListener("DOMContentLoaded", () => {
    const line = document.createElement("div");
    line.id = "scene-note";
    line.textContent = note;
    document.body.append(line);
  });
})();
