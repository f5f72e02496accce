// The tab of the station: marks, the pose by hand, the way back, mapping, recording, and a sound while tracking is lost.
"use strict";

(() => {
  const { own, pick, request } = window.hectorscope;
  const SYMBOLS = { victim: "V", hazard: "!", door: "D", note: "N" };
  const HINTS = { mark: "Click the place of the mark. Escape gives up.", pose: "Press where the robot is, and drag to where it looks. Escape gives up." };
  const BEEP = 1500; // milliseconds from one to the next
  const LEVEL = 0; // the finest

  let now = { marks: [], way: null, records: null, mapping: true, lost: false };
  let doing = null; // "mark" or "pose"
  let drag = null; // [from, to] of one pointer
  let pointer = 0;
  const find = (name) => document.querySelector(`[data-hs-station${name}]`);
  const hint = Object.assign(document.createElement("p"), { className: "hs-measure-hint", hidden: true });
  hint.setAttribute("role", "status");

  function begin(what) {
    doing = doing === what ? null : what;
    drag = null;
    hint.hidden = doing === null;
    hint.textContent = HINTS[doing] ?? "";
    if (doing === null) pick.release("station");
    else pick.take("station", doing === "mark" ? mark : () => {});
    const home = window.__viserMutable?.canvas?.parentElement;
    if (home && hint.parentElement !== home) home.append(hint);
    label();
  }

  // ------------------------------------------------------------------------------------------------ over the scene

  function drawn() {
    const way = (now.way ?? []).map(([x, y]) => pick.project(LEVEL, x, y)).filter(Boolean);
    const line = way.length > 1 ? `<polyline class="hs-station-way" points="${way.map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join(" ")}"/>` : "";
    const marks = now.marks.map(([number, kind, x, y]) => {
      const at = pick.project(LEVEL, x, y);
      return at ? `<g class="hs-station-mark hs-station-${kind}" transform="translate(${at[0].toFixed(1)} ${at[1].toFixed(1)})"><path d="M0 0 L-8 -12 A10.5 10.5 0 1 1 8 -12 Z"/><text y="-15">${SYMBOLS[kind]}${number}</text></g>` : "";
    });
    return line + marks.join("") + arrow();
  }
  function arrow() {
    const ends = (drag ?? []).map(([level, x, y]) => pick.project(level, x, y));
    if (ends.length < 2 || ends.some((end) => !end)) return "";
    const [[ax, ay], [bx, by]] = ends;
    return `<line class="hs-station-pose" x1="${ax}" y1="${ay}" x2="${bx}" y2="${by}"/><circle class="hs-station-pose" cx="${ax}" cy="${ay}" r="6"/>`;
  }
  pick.mark("station", drawn);

  function mark({ clientX, clientY }) {
    const [at] = pick.places(clientX, clientY);
    if (!at) return;
    request("station", { mark: [find("-kind").value, at[1], at[2], find("-text").value] });
    find("-text").value = "";
    begin("mark");
  }

  // While the pose is set the camera must not turn: its listeners are on the canvas, and hear nothing then.
  const grabbed = (event) => doing === "pose" && event.isPrimary && !event.button && event.target === window.__viserMutable?.canvas;
  const place = (event) => pick.places(event.clientX, event.clientY)[0];
  function move(event) {
    if (!drag || event.pointerId !== pointer) return;
    event.stopPropagation();
    const to = place(event);
    if (to) drag[1] = to;
    window.__viserMutable?.requestRender?.();
  }
  document.addEventListener("pointerdown", (event) => {
    const from = grabbed(event) && place(event);
    if (!from) return;
    event.stopPropagation();
    [drag, pointer] = [[from, from], event.pointerId];
  }, true);
  document.addEventListener("pointermove", move, true);
  document.addEventListener("pointerup", (event) => {
    if (!drag || event.pointerId !== pointer) return;
    move(event);
    const [[, ax, ay], [, bx, by]] = drag;
    if (Math.hypot(bx - ax, by - ay) > 0.05) request("station", { pose: [ax, ay, Math.atan2(by - ay, bx - ax)] });
    begin("pose");
  }, true);
  document.addEventListener("pointercancel", () => drag && begin("pose"), true);
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && doing) begin(doing);
  });

  // ------------------------------------------------------------------------------------------------ the tab

  const acts = {
    mark: () => begin("mark"),
    pose: () => begin("pose"),
    way: () => request("station", { way: !now.way }),
    mapping: () => request("station", { mapping: !now.mapping }),
    record: () => request("station", { record: !now.records }),
  };
  document.addEventListener("click", (event) => acts[event.target.closest?.("[data-hs-station]")?.dataset.hsStation]?.());

  function label() {
    const words = { way: now.way ? "Hide the way back" : "Show the way back", mapping: now.mapping ? "Pause mapping" : "Go on mapping", record: now.records ? "Stop recording" : "Record the stream" };
    const pressed = { way: now.way, mapping: !now.mapping, record: now.records, mark: doing === "mark", pose: doing === "pose" };
    for (const button of document.querySelectorAll("button[data-hs-station]")) {
      const act = button.dataset.hsStation;
      if (words[act] && button.textContent !== words[act]) button.textContent = words[act];
      button.setAttribute("aria-pressed", String(!!pressed[act]));
      if (act === "pose") button.hidden = !now.live;
      if (act === "record") button.hidden = now.records === null;
    }
    const told = find("-recorded");
    if (told) told.textContent = now.records === null ? "" : `${now.recorded} MB recorded`;
  }

  // A picture is made small here, so that one message holds it; the server decodes it and makes it anew.
  const SIDES = [1024, 800, 640, 480, 320]; // pixels
  const QUALITIES = [0.8, 0.6, 0.4];
  const addresses = new Map(); // of the pictures, by their keys
  async function small(file) {
    const image = await createImageBitmap(file);
    const canvas = document.createElement("canvas");
    for (const side of SIDES) {
      const scale = Math.min(1, side / Math.max(image.width, image.height));
      [canvas.width, canvas.height] = [image.width, image.height].map((each) => Math.max(1, Math.round(each * scale)));
      canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
      for (const quality of QUALITIES) {
        const content = canvas.toDataURL("image/jpeg", quality).split(",")[1];
        if (content.length * 0.75 <= now.most) return content;
      }
    }
    throw new Error("too large");
  }
  async function send(number, file) {
    const told = find("-picture-told");
    told.textContent = "";
    try {
      request("station", { picture: [number, await small(file)] });
    } catch {
      told.textContent = "This file cannot be read as a picture: choose a whole JPEG, PNG or WebP.";
    }
  }
  function chooser(number) {
    const label = Object.assign(document.createElement("label"), { className: "hs-reset hs-station-camera", textContent: "📷", title: `A picture for mark ${number}` });
    const field = Object.assign(document.createElement("input"), { type: "file", accept: "image/*" });
    if (matchMedia("(pointer: coarse)").matches) field.setAttribute("capture", "environment");
    field.setAttribute("aria-label", `Picture for mark ${number}`);
    field.addEventListener("change", () => { if (field.files[0]) send(number, field.files[0]); field.value = ""; field.blur(); });
    label.append(field);
    return label;
  }
  function thumbnail(number, key) {
    const link = Object.assign(document.createElement("a"), { className: "hs-station-picture", target: "_blank", rel: "noopener" });
    const image = Object.assign(document.createElement("img"), { alt: `Picture of mark ${number}` });
    link.dataset.hsPicture = key;
    link.append(image);
    fill(link);
    return link;
  }
  function fill(link) {
    const address = addresses.get(link.dataset.hsPicture);
    if (address) link.href = link.firstChild.src = address;
    else request("pictures", { key: link.dataset.hsPicture });
  }
  function pictured(key, content) {
    if (!addresses.has(key)) {
      const bytes = Uint8Array.from(atob(content), (letter) => letter.charCodeAt(0));
      addresses.set(key, URL.createObjectURL(new Blob([bytes], { type: "image/jpeg" })));
    }
    for (const link of document.querySelectorAll(`[data-hs-picture="${key}"]`)) fill(link);
  }

  let listed = "";
  function list() {
    const home = find("-marks");
    const key = JSON.stringify(now.marks);
    if (!home || (key === listed && home.childElementCount === now.marks.length) || home.contains(document.activeElement)) return;
    listed = key;
    home.replaceChildren(...now.marks.map(([number, kind, x, y, text, key]) => {
      const row = document.createElement("li");
      const name = Object.assign(document.createElement("b"), { textContent: `${number} ${kind}`, title: `x ${x.toFixed(2)} m, y ${y.toFixed(2)} m` });
      const field = Object.assign(document.createElement("input"), { type: "text", maxLength: 200, value: text });
      field.setAttribute("aria-label", `Text of mark ${number}`);
      field.addEventListener("change", () => { request("station", { edit: [number, kind, field.value] }); field.blur(); });
      const away = Object.assign(document.createElement("button"), { type: "button", className: "hs-reset", textContent: "×", title: `Remove mark ${number}` });
      away.addEventListener("click", () => { away.blur(); request("station", { remove: number }); });
      row.append(name, field, ...(key ? [thumbnail(number, key)] : []), chooser(number), away);
      return row;
    }));
  }

  // ------------------------------------------------------------------------------------------------ the sound

  let audio = null;
  const loud = () => own.get("sound");
  own.listen((name) => {
    if (name !== "sound" || !loud()) return;
    wake();
    beep();
  });
  function wake() { // browsers let a page sound only once somebody has touched it
    if (!loud()) return;
    audio ??= new AudioContext();
    audio.resume();
  }
  document.addEventListener("pointerdown", wake, true);
  let beeps = 0;
  function beep() {
    if (!audio) return;
    for (const [at, pitch] of [[0, 880], [0.22, 660]]) {
      const [tone, volume] = [audio.createOscillator(), audio.createGain()];
      tone.frequency.value = pitch;
      volume.gain.value = 0.25;
      tone.connect(volume).connect(audio.destination);
      tone.start(audio.currentTime + at);
      tone.stop(audio.currentTime + at + 0.18);
    }
    beeps += 1;
  }
  setInterval(() => { if (now.lost && loud()) beep(); }, BEEP);

  function station(told) {
    const began = told.lost && !now.lost;
    now = told;
    label();
    list();
    if (began && loud()) beep();
    window.__viserMutable?.requestRender?.();
  }
  Object.assign(window.hectorscope, { station, pictured, beeps: () => beeps });
})();
