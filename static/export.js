// What this browser takes with it: asks the server for an archive of chosen formats, keeps the notes for a replay, and
// records a video of the scene.
"use strict";

(() => {
  const hectorscope = window.hectorscope;
  const RATE = 25; // pictures a second of a video
  const KINDS = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"];
  const notes = []; // [seconds, text]

  const shown = () => {
    const { values, width, count } = hectorscope.plotted().tables.series ?? { count: 0 };
    return count ? values[(count - 1) * width] : 0;
  };

  function ask() {
    const boxes = [...document.querySelectorAll("[data-hs-format]")];
    const formats = boxes.filter((box) => box.checked).map((box) => box.dataset.hsFormat);
    if (formats.length) hectorscope.request("export", { formats, notes });
  }

  function list() {
    const home = document.querySelector("[data-hs-notes]");
    home?.replaceChildren(...notes.map(([at, text], i) => {
      const row = Object.assign(document.createElement("li"), { textContent: `${at.toFixed(1)} s: ${text} ` });
      const away = Object.assign(document.createElement("button"), { type: "button", className: "hs-reset", textContent: "×", title: "Remove the note" });
      away.addEventListener("click", () => { notes.splice(i, 1); list(); });
      row.append(away);
      return row;
    }));
  }

  function pin() {
    const field = document.querySelector("[data-hs-note-text]");
    if (!field?.value.trim()) return;
    notes.push([+shown().toFixed(2), field.value.trim()]);
    notes.sort(([a], [b]) => a - b);
    field.value = "";
    list();
  }

  // ----------------------------------------------------------------------------------------------- video

  let recorder = null;
  function label() {
    const button = document.querySelector("[data-hs-do=video]");
    if (!button) return;
    button.setAttribute("aria-pressed", String(!!recorder));
    button.textContent = recorder ? "End the video and save it" : "Record a video";
  }

  function video() {
    if (recorder) {
      recorder.stop();
      return;
    }
    const scene = window.__viserMutable?.canvas;
    const mimeType = window.MediaRecorder && KINDS.find((kind) => MediaRecorder.isTypeSupported(kind));
    if (!scene || !mimeType) return;
    const sheet = Object.assign(document.createElement("canvas"), { width: scene.width, height: scene.height });
    const [ctx, parts] = [sheet.getContext("2d"), []];
    // The scene has no background of its own, and is there only in the frame in which it was drawn.
    const draw = () => hectorscope.pictureOf(scene, ctx, sheet.width, sheet.height);
    hectorscope.drawn.add(draw);
    recorder = new MediaRecorder(sheet.captureStream(RATE), { mimeType });
    const beat = setInterval(() => window.__viserMutable?.requestRender?.(), 1000 / RATE);
    recorder.ondataavailable = ({ data }) => parts.push(data);
    recorder.onstop = () => {
      clearInterval(beat);
      hectorscope.drawn.delete(draw);
      recorder = null;
      label();
      hectorscope.save(new Blob(parts, { type: mimeType }), `hectorscope.${mimeType.includes("mp4") ? "mp4" : "webm"}`);
    };
    recorder.start(1000);
    label();
  }

  Object.assign(hectorscope, { exporting: { ask, pin, video, notes } });
})();
