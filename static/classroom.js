// A class: the page that was opened by the teacher's link tells the server what it looks at; the others follow that, or
// explore on their own. The time is that of the run, which all share. Touching the scene ends following, a button begins
// it again. What a browser had chosen for itself comes back then.
"use strict";

(() => {
  const { own } = window.hectorscope;
  const SAID = 250; // milliseconds between two looks at what the teacher looks at
  const TEACHER = "hectorscope-teacher";
  const SHARED = ["layout", "gap", "level", "layers"];

  const bar = Object.assign(document.createElement("p"), { className: "hs-class", hidden: true });
  bar.innerHTML = '<span role="status"></span><button type="button"></button>';
  document.body.append(bar);
  const [words, button] = bar.children;

  // The key is in the part of the address that no server is sent; it is kept as long as the tab is open.
  const given = new URLSearchParams((window.hectorscope.asked ?? location.hash).slice(1)).get("teach");
  let key = given;
  try {
    if (given) sessionStorage.setItem(TEACHER, given);
    key = sessionStorage.getItem(TEACHER);
  } catch {
    // Without storage the page has to be opened by the link again.
  }
  if (given) history.replaceState(null, "", location.pathname + location.search);

  const told = () => document.querySelector("[data-hs-class]")?.dataset.hsClass;
  const mode = ({ auto, follow, top }) => (follow ? "follow" : top ? "top" : auto ? "fit" : "free");

  // --------------------------------------------------------------------------------------------------- teacher

  let said = "";
  function teach() {
    const now = window.__viserMutable?.cameraControl && window.hectorscope.cameraNow?.();
    if (!now) return;
    const view = { camera: [mode(now), ...now.pose], ...Object.fromEntries(SHARED.map((name) => [name, own.get(name)])) };
    // Until the server has it: the first word may go to a connection that viser gives up.
    const text = JSON.stringify(view);
    if (text === said && told() !== "{}") return;
    said = text;
    window.hectorscope.request("class", { key, view });
  }

  // -------------------------------------------------------------------------------------------------- students

  let following = true;
  let seen = "";
  let before = null; // what this browser had chosen for itself

  function apply(view) {
    before ??= Object.fromEntries(SHARED.map((name) => [name, own.get(name)]));
    for (const name of SHARED) if (JSON.stringify(own.get(name)) !== JSON.stringify(view[name])) own.set(name, view[name]);
    const [wanted, ...pose] = view.camera;
    if (wanted !== mode(window.hectorscope.cameraState())) window.hectorscope.camera(wanted);
    if (wanted === "free") window.__viserMutable.cameraControl.setLookAt(...pose, !window.hectorscope.lessMotion());
  }

  function explore() {
    following = false;
    if (before) for (const name of SHARED) own.set(name, before[name]);
    before = null;
  }

  function follow() {
    [following, seen] = [true, ""];
  }
  button.addEventListener("click", () => (following ? explore() : follow()));
  for (const kind of ["pointerdown", "wheel"])
    document.addEventListener(kind, ({ target }) => {
      if (isStudent() && following && target === window.__viserMutable?.canvas) explore();
    }, true);

  const isClass = () => told() !== undefined;
  const isStudent = () => isClass() && !key;

  function look() {
    bar.hidden = !isClass();
    if (bar.hidden) return;
    button.hidden = Boolean(key);
    if (key) {
      words.textContent = "The class sees this view";
      teach();
      return;
    }
    words.textContent = following ? "Following the teacher" : "On your own";
    button.textContent = following ? "Explore" : "Follow";
    const text = told();
    if (!following || text === seen || text === "{}" || !window.__viserMutable?.cameraControl || !window.hectorscope.levels().places.length) return;
    seen = text;
    apply(JSON.parse(text));
  }
  setInterval(look, SAID);

  Object.assign(window.hectorscope, { classroom: { isStudent, follows: () => isStudent() && following } });
})();
