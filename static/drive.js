// Driving a simulated robot: a card with a joystick, errors of the sensors, doors and boxes. The arrow keys steer while
// nothing else has the focus, W A S D too while the joystick has it. What is asked for goes to the server, which checks
// it (panels/drive.py). Held keys are said again and again: without a word the robot stops.
"use strict";

(() => {
  const SAID = 120; // milliseconds between two words to the robot
  const DIRECTIONS = { arrowup: [1, 0], arrowdown: [-1, 0], arrowleft: [0, 1], arrowright: [0, -1] };
  const LETTERS = { w: "arrowup", s: "arrowdown", a: "arrowleft", d: "arrowright" };
  const ask = (wanted) => window.hectorscope.request("drive", wanted);

  const card = Object.assign(document.createElement("section"), { className: "hs-drive", hidden: true });
  card.setAttribute("aria-label", "Drive the robot");
  card.innerHTML = `<header><h2>Drive</h2><button type="button" data-hs-fold aria-label="Fold" aria-expanded="true">–</button></header>
    <div class="hs-drive-body"><div class="hs-pad" tabindex="0" role="application" aria-label="Joystick: drag, or arrow keys and W A S D"><i></i></div>
    <p class="hs-drive-keys">Drag, or use the arrow keys. With the joystick in focus, <kbd>W</kbd> <kbd>A</kbd> <kbd>S</kbd> <kbd>D</kbd> too.</p>
    <div class="hs-drive-things"></div><details><summary>Errors of the sensors</summary><div class="hs-drive-faults"></div></details></div>`;
  const [pad, knob, things, faults] = [".hs-pad", ".hs-pad i", ".hs-drive-things", ".hs-drive-faults"].map((each) => card.querySelector(each));

  // ---------------------------------------------------------------------------------------------- steering

  const held = new Set();
  let dragged = null;
  let timer = 0;

  const fromKeys = () => [...held].reduce(([f, t], key) => [f + DIRECTIONS[key][0], t + DIRECTIONS[key][1]], [0, 0]);
  function say() {
    const steer = dragged ?? fromKeys();
    ask({ steer });
    if (!dragged && !held.size) {
      clearInterval(timer);
      timer = 0;
    }
    knob.style.translate = `${-32 * steer[1]}px ${-32 * steer[0]}px`;
  }
  function begin() {
    say();
    if (!timer) timer = setInterval(say, SAID);
  }
  function stop() {
    held.clear();
    dragged = null;
    if (timer) say();
  }

  // The scene has the focus while nothing else has it.
  const onScene = () => [document.body, window.__viserMutable?.canvas].includes(document.activeElement) || document.activeElement?.matches("canvas");
  function keyOf(event) {
    const name = event.key.toLowerCase();
    const onPad = document.activeElement === pad;
    const key = onPad ? LETTERS[name] ?? name : name;
    return key in DIRECTIONS && (onPad || onScene()) ? key : null;
  }
  window.addEventListener("keydown", (event) => {
    if (card.hidden || event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
    const key = keyOf(event);
    if (!key) return;
    event.preventDefault();
    event.stopImmediatePropagation(); // viser moves its camera by the same keys
    if (!held.has(key)) {
      held.add(key);
      begin();
    }
  }, true);
  window.addEventListener("keyup", (event) => {
    const key = event.key.toLowerCase();
    if (held.delete(LETTERS[key] ?? key) | held.delete(key)) say();
  }, true);
  addEventListener("blur", stop);
  document.addEventListener("visibilitychange", stop);

  function drag(event) {
    const box = pad.getBoundingClientRect();
    const share = (at, from, size) => Math.min(Math.max((2 * (at - from)) / size - 1, -1), 1);
    dragged = [-share(event.clientY, box.top, box.height), -share(event.clientX, box.left, box.width)];
  }
  pad.addEventListener("pointerdown", (event) => {
    pad.setPointerCapture(event.pointerId);
    drag(event);
    begin();
  });
  pad.addEventListener("pointermove", (event) => dragged && drag(event));
  for (const end of ["pointerup", "pointercancel"]) pad.addEventListener(end, () => { dragged = null; say(); });

  // ---------------------------------------------------------------------------------------- doors and boxes

  const { element, pick } = window.hectorscope;
  const button = (words, hint, act) => element("button", { type: "button", textContent: words, title: hint, onclick: act });
  let placing = null; // the number of the box that the next click puts somewhere

  function arrange({ doors, boxes }) {
    const open = doors.map((isOpen, door) => button(`${isOpen ? "Close" : "Open"} door ${door + 1}`, "", () => ask({ door, open: !isOpen })));
    const boxed = boxes.flatMap((there, box) => [
      button(`Box ${box + 1} ahead`, "Put it in front of the robot", () => ask({ box, at: "ahead" })),
      button(placing === box ? "Click the map" : "Place", `Box ${box + 1}: then click where`, () => place(placing === box ? null : box)),
      ...(there ? [button("Take away", `Box ${box + 1}`, () => ask({ box, at: null }))] : []),
    ]);
    things.replaceChildren(...open, ...boxed);
  }

  function place(box) {
    placing = box;
    told.text = "";
    if (box === null) pick.release("box");
    else pick.take("box", ({ clientX, clientY }) => {
      const [at] = pick.places(clientX, clientY);
      if (at) ask({ box, at: at.slice(1) });
      place(null);
    });
  }
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && placing !== null) place(null);
  });

  // ------------------------------------------------------------------------------------------------- errors

  function slider({ name, title, unit, low, high, value }) {
    const shown = element("output", {});
    const input = element("input", { type: "range", min: low, max: high, step: (high - low) / 200, value });
    input.setAttribute("aria-label", title);
    input.addEventListener("input", () => ask({ fault: name, value: Number(input.value) }));
    const row = element("label", {}, element("span", { textContent: title }), shown, input, element("small", {}));
    row.dataset.fault = name;
    row.dataset.unit = unit;
    return row;
  }

  function tell({ faults: list, found }) {
    if (faults.childElementCount !== list.length) faults.replaceChildren(...list.map(slider));
    for (const { name, unit, value } of list) {
      const row = faults.querySelector(`[data-fault="${name}"]`);
      row.querySelector("output").textContent = `${+value.toFixed(3)} ${unit}`;
      if (document.activeElement !== row.querySelector("input")) row.querySelector("input").value = value;
      row.querySelector("small").textContent = found[name] ? `the filter estimates ${found[name]}` : "";
    }
  }

  const told = { text: "", things: "" };
  function look() {
    const text = document.querySelector("[data-hs-drive]")?.dataset.hsDrive ?? "";
    card.hidden = !text;
    document.documentElement.toggleAttribute("data-hs-driven", Boolean(text));
    if (!text || text === told.text) return;
    const state = JSON.parse(text);
    told.text = text;
    tell(state);
    const now = JSON.stringify([state.doors, state.boxes, placing]);
    if (now !== told.things) arrange(state); // a button that is pressed stays the same one
    told.things = now;
  }
  setInterval(look, 150);

  const fold = card.querySelector("[data-hs-fold]");
  fold.addEventListener("click", () => {
    const folded = card.toggleAttribute("data-folded");
    fold.setAttribute("aria-expanded", String(!folded));
    fold.textContent = folded ? "+" : "–";
  });
  document.body.append(card);
})();
