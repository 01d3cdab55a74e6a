"use strict";
// Read before viser's client. It leans on three of the client's inner parts, so the tests pin viser's version:
// the messages its worker posts, `window.__viserMutable` and its habit of retrying only while it has the focus.
(() => {
  const { exchange, note } = window.vsseaScene;

  // viser reconnects only while the page has the focus; a scene beside the plots seldom has it.
  document.hasFocus = () => true;

  // One server draws for all pages in the dark page's colours; a light page exchanges them as they arrive.
  const recolour = ({ props }) => {
    const other = props?.color && exchange[Array.from(props.color).join(",")];
    if (other) props.color = other;
  };
  const NativeWorker = window.Worker;
  window.Worker = class extends NativeWorker {
    set onmessage(handler) {
      super.onmessage = (event) => {
        if (event.data?.type === "message_batch") event.data.messages.forEach(recolour);
        handler(event);
      };
    }
    get onmessage() {
      return super.onmessage;
    }
  };

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
