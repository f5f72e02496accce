// Inside the matcher, for the scan at which the run rests: a card in the place of the panels, and marks over the scene.
// The server works it out (panels/xray.py), for this browser alone. I opens and closes it.
"use strict";

(() => {
  const hectorscope = window.hectorscope;
  const { own, pick } = hectorscope;
  const PLAY = 900; // milliseconds that an iteration is shown
  const SOON = 60; // milliseconds between two requests of a slider
  const LEGIBLE = 48; // pixels of a cell that has its name in it
  const NARROW = 280; // pixels: less room beside the scene than this, and the card lies over it
  const LABS = { steps: "Steps", landscape: "Landscape", lens: "Lens", covariance: "Covariance", attitude: "Attitude" };
  const wanted = { lab: "steps", step: 0, level: 0, plane: "xy", span: 1, yaw: 0, show: "heat", at: null, omega: 0.5, noise: 0.02, of: "scan", pitch: 0, keep: false };
  let open = false;
  let steps = 0;
  let levels = 0;
  let playing = 0;

  const card = document.createElement("section");
  card.className = "hs-xray";
  card.setAttribute("aria-label", "Inside the matcher");
  card.hidden = true;
  const group = (name, options) => `<span class="hs-group" role="group">${Object.entries(options).map(([value, text]) => `<button type="button" data-hs-xray="${name}" data-hs-to="${value}">${text}</button>`).join("")}</span>`;
  const range = (name, text, low, high, step) => `<label>${text}<input type="range" data-hs-xray="${name}" min="${low}" max="${high}" step="${step}" aria-label="${text}"><output></output></label>`;
  card.innerHTML = `<header><h2>Inside the matcher</h2><button type="button" class="hs-tool" data-hs-xray="close" title="Close · I" aria-label="Close the X-ray"><svg viewBox="0 0 24 24"><path d="M6 6l12 12M18 6 6 18"/></svg></button></header>
    <p class="hs-xray-scan"><span></span><button type="button" data-hs-xray="keep" title="The run may go on without it; each browser keeps its own">Keep this scan</button></p>
    <p class="hs-xray-go"><span class="hs-group"><button type="button" data-hs-xray="scan" data-hs-to="-1" aria-label="Scan before, for this browser alone">‹</button><button type="button" data-hs-xray="scan" data-hs-to="1" aria-label="Next scan, for this browser alone">›</button></span><input type="range" min="0" max="0" step="0.1" aria-label="Scan of this browser alone, by its time" title="Another scan of the recording, for this browser alone"></p>
    ${group("lab", LABS)}
    <div data-hs-lab="steps"><span class="hs-group"><button type="button" data-hs-xray="by" data-hs-to="-1" aria-label="Iteration before">‹</button><button type="button" data-hs-xray="play">Play</button><button type="button" data-hs-xray="by" data-hs-to="1" aria-label="Next iteration">›</button></span>${range("step", "Iteration", 0, 0, 1)}
      <p class="hs-xray-legend">Beams by residual 0<i class="hs-ramp"></i>1 · lines: ∇M · drag the handle to start elsewhere</p></div>
    <div data-hs-lab="landscape"><p>Level ${group("level", {})}</p><p>Plane ${group("plane", { xy: "x, y", xyaw: "x, ψ" })}</p><p>Show ${group("show", { heat: "cost (7)", surface: "surface", basin: "basin" })}</p>
      ${range("span", "Reach, m", 0.1, 5, 0.1)}${range("yaw", "Turned, °", -30, 30, 0.5)}
      <p class="hs-xray-legend"><span class="hs-of-cost">Bright: low cost. </span><span class="hs-of-basin">Green: ends at ξ*; red: elsewhere. </span>Drag the handle to start elsewhere.</p></div>
    <div data-hs-lab="lens"><p class="hs-xray-legend">Click a place of the map, on any level.</p></div>
    <div data-hs-lab="covariance"><p>Of ${group("of", { scan: "this scan", places: "room, corridor, water" })}</p>${range("omega", "ω", 0.001, 0.999, 0.001)}${range("noise", "Noise, mm", 1, 200, 1)}</div>
    <div data-hs-lab="attitude">${range("pitch", "Pitch θ, °", 0, 90, 0.5)}</div>
    <p><button type="button" class="hs-xray-home" data-hs-xray="home">Start as the run did</button></p>
    <div class="hs-xray-words" aria-live="off"></div>`;
  document.body.append(card);
  const words = card.querySelector(".hs-xray-words");
  const slider = card.querySelector(".hs-xray-go input");
  const FACTORS = { yaw: Math.PI / 180, pitch: Math.PI / 180, noise: 0.001 };

  // What the run itself draws at the robot would lie over what is drawn here.
  const INSIDE = /\/xray\/(heat|surface|gradients|points)$/;
  const HIDDEN = ["/robot", "/floor/scan", "/floor/prior", "/floor/match", "/floor/fused", "/position", "/floor/footprint", "/frames"];
  hectorscope.drawing.push((page) => {
    if (!open) return;
    for (const name of HIDDEN) if (page.nodeRefFromName[name]) page.nodeRefFromName[name].visible = false;
    for (const [name, node] of Object.entries(page.nodeRefFromName)) {
      const kind = name.match(INSIDE)?.[1];
      if (kind) node?.traverse((child) => order(child, kind));
    }
  });

  // What is drawn inside lies over the map, and lines and points over the heat map.
  function order(child, kind) {
    if (!child.material) return;
    child.renderOrder = kind === "heat" ? 0 : 1;
    if (kind === "heat") child.material.depthWrite = false;
  }

  // ------------------------------------------------------------------------------------------------ asking

  let late = 0;
  let asked = 0;
  function ask() {
    clearTimeout(late);
    const wait = asked + SOON - performance.now();
    if (wait > 0) {
      late = setTimeout(ask, wait);
      return;
    }
    asked = performance.now();
    if (open) hectorscope.request("xray", wanted);
  }

  // Another scan of the recording, which stays while the run goes on.
  function go(where) {
    wanted.keep = true;
    dress();
    hectorscope.request("xray", where);
  }

  function want(name, value) {
    wanted[name] = value;
    if (name === "lab") claim();
    dress();
    ask();
  }

  function stop() {
    clearInterval(playing);
    playing = 0;
    dress();
  }

  function play() {
    if (playing) return stop();
    if (wanted.step >= steps - 1) want("step", 0);
    playing = setInterval(() => (wanted.step < steps - 1 && open ? want("step", wanted.step + 1) : stop()), PLAY);
    dress();
  }

  // The lens is moved by clicks.
  function claim() {
    if (open && wanted.lab === "lens") pick.take("lens", aim);
    else pick.release("lens");
  }

  function toggle(to = !open) {
    open = to;
    card.hidden = !open;
    document.documentElement.classList.toggle("hs-looking-inside", open);
    claim();
    if (open) {
      place();
      if (window.__viserMutable?.canvas) beside.observe(window.__viserMutable.canvas);
      dress();
      ask();
    } else {
      beside.disconnect();
      stop();
      pick.mark("xray", null);
      words.textContent = "";
      hectorscope.request("xray", { open: false });
    }
  }

  const ACTS = {
    close: () => toggle(false),
    play,
    by: (to) => (stop(), want("step", Math.min(Math.max(wanted.step + Number(to), 0), Math.max(steps - 1, 0)))),
    home: () => hectorscope.request("xray", { home: true }),
    keep: () => want("keep", !wanted.keep),
    scan: (to) => go({ scan_by: Number(to) }),
    lab: (to) => (stop(), want("lab", to)),
    level: (to) => want("level", Number(to)),
    plane: (to) => want("plane", to),
    of: (to) => want("of", to),
    show: (to) => want("show", to),
  };
  card.addEventListener("click", ({ target }) => {
    const at = target.closest("button[data-hs-xray]");
    if (at) ACTS[at.dataset.hsXray]?.(at.dataset.hsTo);
  });
  card.addEventListener("input", ({ target }) => {
    const name = target.dataset.hsXray;
    if (name === "step") stop();
    if (name) want(name, Number(target.value) * (FACTORS[name] ?? 1));
  });
  slider.addEventListener("change", () => go({ scan_at: Number(slider.value) }));
  for (const kind of ["keydown", "keyup"]) card.addEventListener(kind, (event) => event.target.type === "range" && event.stopPropagation());

  // ----------------------------------------------------------------------------------------------- the card

  // In the place of the panels if they are there, else over the scene.
  function place() {
    const canvas = window.__viserMutable?.canvas?.getBoundingClientRect();
    if (!canvas?.width) return;
    const beside = innerWidth - canvas.right >= NARROW;
    const low = innerWidth < 576;
    Object.assign(card.style, {
      left: low ? "0" : beside ? `${canvas.right}px` : "auto",
      right: "0",
      top: low ? `${innerHeight / 2}px` : `${canvas.top}px`,
      bottom: low ? "0" : `${innerHeight - canvas.bottom}px`,
      width: low || beside ? "auto" : "340px",
    });
  }

  function dress() {
    for (const part of card.querySelectorAll("[data-hs-lab]")) part.hidden = part.dataset.hsLab !== wanted.lab;
    for (const button of card.querySelectorAll("button[data-hs-to]")) {
      const name = button.dataset.hsXray;
      if (name in wanted) button.setAttribute("aria-pressed", String(String(wanted[name]) === button.dataset.hsTo));
    }
    for (const input of card.querySelectorAll("input[data-hs-xray]")) {
      const name = input.dataset.hsXray;
      const value = wanted[name] / (FACTORS[name] ?? 1);
      if (name === "step") input.max = String(Math.max(steps - 1, 0));
      if (input !== document.activeElement || name === "step") input.value = String(value);
      input.nextElementSibling.textContent = name === "step" ? `${wanted.step + 1} of ${steps}` : String(+value.toFixed(3));
    }
    card.querySelector("[data-hs-xray=play]").textContent = playing ? "Stop" : "Play";
    card.querySelector(".hs-of-cost").hidden = wanted.show === "basin";
    card.querySelector(".hs-of-basin").hidden = wanted.show !== "basin";
    card.querySelector("[data-hs-xray=yaw]").closest("label").hidden = wanted.plane !== "xy";
    card.querySelector("[data-hs-xray=keep]").setAttribute("aria-pressed", String(wanted.keep));
    card.querySelector("[data-hs-xray=omega]").closest("label").hidden = wanted.of === "places";
    card.querySelector(".hs-xray-home").hidden = !["steps", "landscape"].includes(wanted.lab);
  }

  function buttons() {
    const home = card.querySelector("[data-hs-lab=landscape] .hs-group");
    home.innerHTML = Array.from({ length: levels }, (_, i) => `<button type="button" data-hs-xray="level" data-hs-to="${i}">${i}</button>`).join("");
  }

  // ------------------------------------------------------------------------------------------------ showing

  function drawn(marks) {
    return marks.map(({ kind, at, closed, text }) => {
      const points = at.map((point) => pick.project(...point));
      if (points.some((point) => !point)) return "";
      const shape = `<${closed ? "polygon" : "polyline"} class="hs-xray-${kind}" points="${points.map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join(" ")}"/>`;
      const [x, y] = closed ? [0, 1].map((i) => points.reduce((sum, point) => sum + point[i], 0) / points.length) : points[points.length - 1];
      const wide = kind !== "cell" || Math.hypot(points[1][0] - points[0][0], points[1][1] - points[0][1]) > LEGIBLE;
      return `${shape}${text && wide ? `<text class="hs-xray-name" x="${(x + 4).toFixed(1)}" y="${(y - 4).toFixed(1)}">${text}</text>` : ""}`;
    }).join("");
  }

  function show(told) {
    if (!open) return;
    if (words.innerHTML !== told.words) words.innerHTML = told.words;
    card.querySelector(".hs-xray-scan").hidden = told.scan === null;
    if (told.scan !== null) card.querySelector(".hs-xray-scan span").textContent = `Scan at ${told.scan.toFixed(2)} s`;
    card.querySelector(".hs-xray-go").hidden = !told.last;
    slider.max = String(told.last);
    if (told.scan !== null && slider !== document.activeElement) slider.value = String(told.scan);
    if (told.levels && told.levels !== levels || told.steps && told.steps !== steps) {
      [levels, steps] = [told.levels, told.steps || steps];
      wanted.step = Math.min(wanted.step, Math.max(steps - 1, 0));
      buttons();
    }
    // Where one level is shown alone, it is the one of which this is told.
    if (told.level !== null && told.level !== own.get("level")) own.set("level", told.level);
    dress();
    pick.mark("xray", () => drawn(told.marks));
  }

  function aim({ clientX, clientY }) {
    const [at] = pick.places(clientX, clientY);
    if (at) want("at", at);
  }
  addEventListener("resize", () => open && place());
  const beside = new ResizeObserver(place);

  Object.assign(hectorscope, { xray: { show, toggle, want } });
})();
