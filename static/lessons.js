// Guided lessons: a card at the right of the scene. The server makes their HTML (page/lessons.py) and sets up their scenes;
// it tells what the run does, and this script compares that, and what this browser shows, with what counts as done.
// Answers and what is done are remembered in this browser only.
"use strict";

(() => {
  const KEPT = "hectorscope-lessons";
  const { own } = window.hectorscope;
  const LOOK = 250; // milliseconds

  const card = Object.assign(document.createElement("section"), { className: "hs-lessons", hidden: true });
  card.setAttribute("aria-label", "Lessons");
  document.body.append(card);
  let lessons = null; // as the server has them
  let shown = null; // the key of the lesson that is open
  let known = stored();

  function stored() {
    try {
      const found = JSON.parse(localStorage.getItem(KEPT)) ?? {};
      return { answers: { ...found.answers }, done: { ...found.done } };
    } catch {
      return { answers: {}, done: {} };
    }
  }
  function keep() {
    try {
      localStorage.setItem(KEPT, JSON.stringify(known));
    } catch {
      // Without storage it lasts as long as the page.
    }
  }

  // ------------------------------------------------------------------------------------------------- formulas

  let katex = null;
  function formulas() {
    katex ??= new Promise((resolve) => {
      document.head.append(Object.assign(document.createElement("link"), { rel: "stylesheet", href: "static/katex/katex.min.css" }));
      const script = Object.assign(document.createElement("script"), { src: "static/katex/katex.min.js", onload: () => resolve(window.katex), onerror: () => resolve(null) });
      document.head.append(script);
    });
    return katex;
  }
  async function typeset() {
    const found = await formulas();
    for (const at of card.querySelectorAll(".hs-tex:not([data-set])")) {
      at.dataset.set = "";
      found?.render(at.textContent, at, { displayMode: at.classList.contains("hs-tex-block"), throwOnError: false });
    }
  }

  // ----------------------------------------------------------------------------------------------------- facts

  const TESTS = { "==": (a, b) => a === b, "!=": (a, b) => a !== b, "<": (a, b) => a < b, ">": (a, b) => a > b, "<=": (a, b) => a <= b, ">=": (a, b) => a >= b };
  const looked = () => {
    const closer = document.querySelector(".hs-closer");
    if (!closer || closer.hidden) return "";
    return closer.querySelector("[data-hs-beam]") ? "beam" : "cell";
  };
  function facts() {
    const told = JSON.parse(document.querySelector("[data-hs-facts]")?.dataset.hsFacts ?? "{}");
    return { ...told, closer: looked(), layout: own.get("layout"), plots: own.get("plots") };
  }
  const holds = ({ done }, now) => done.every(({ fact, test, value }) => fact in now && TESTS[test](now[fact], value));

  // The scene is there before a task can be done: until then what was before might count.
  let ready = false;
  function look() {
    const lesson = lessons?.find(({ key }) => key === shown);
    if (card.hidden || !lesson) return;
    const held = holds(lesson, facts());
    ready ||= !held;
    if (ready && held && !known.done[shown]) {
      known.done[shown] = true;
      keep();
      mark();
    }
  }
  setInterval(look, LOOK);
  const mark = () => card.querySelector(".hs-task")?.toggleAttribute("data-done", Boolean(known.done[shown]));

  // ---------------------------------------------------------------------------------------------------- drawing

  const CLOSE = '<button type="button" class="hs-tool" data-close aria-label="Close the lessons" title="Close · E"><svg viewBox="0 0 24 24"><path d="M6 6l12 12M18 6 6 18"/></svg></button>';
  const plain = (text) => Object.assign(document.createElement("i"), { textContent: text }).innerHTML;

  function list() {
    shown = null;
    const rows = lessons.map(({ key, title }) => `<li${known.done[key] ? " data-done" : ""}><button type="button" data-open="${plain(key)}">${plain(title)}</button></li>`);
    card.innerHTML = `<header><h2>Lessons</h2>${CLOSE}</header><p>Each sets up its scene, has one thing to try, and one question. The run is shared by every browser.</p><ol class="hs-lesson-list">${rows.join("")}</ol>`;
  }

  function open(key, setUp = true) {
    const at = lessons.findIndex((each) => each.key === key);
    const lesson = lessons[at];
    [shown, ready] = [key, false];
    const step = (other, words) => (other ? `<button type="button" data-open="${plain(other.key)}">${words}</button>` : "<span></span>");
    const answers = lesson.question.answers.map((answer, index) => `<button type="button" data-answer="${index}">${answer}</button>`);
    card.innerHTML = `<header><button type="button" data-list>All lessons</button><small>${at + 1} of ${lessons.length}</small>${CLOSE}</header>
      <h2>${plain(lesson.title)}</h2><div class="hs-lesson-body">${lesson.body}</div>
      <div class="hs-task"><h3>Try it</h3><p>${lesson.task}</p><p class="hs-task-done" role="status">Done.</p><button type="button" data-set-up>Set up the scene again</button></div>
      <div class="hs-question"><h3>Question</h3><p>${lesson.question.text}</p>${answers.join("")}<p class="hs-why" role="status"></p></div>
      <footer>${step(lessons[at - 1], "Before")}${step(lessons[at + 1], "Next")}</footer>`;
    card.scrollTop = 0;
    mark();
    answered();
    typeset();
    if (setUp) arrange(lesson);
  }

  function arrange(lesson) {
    ready = false;
    for (const [name, value] of Object.entries(lesson.browser)) own.set(name, value);
    if (!window.hectorscope.classroom?.isStudent()) window.hectorscope.request("lesson", { set_up: lesson.key });
  }

  function answered() {
    const [chosen, { question }] = [known.answers[shown], lessons.find(({ key }) => key === shown)];
    card.querySelectorAll("[data-answer]").forEach((at, index) => {
      at.setAttribute("aria-pressed", String(index === chosen));
      at.dataset.right = String(index === question.right);
    });
    card.querySelector(".hs-why").innerHTML = chosen === undefined ? "" : `<b>${chosen === question.right ? "Right." : "Not quite."}</b> ${question.why}`;
    typeset();
  }

  card.addEventListener("click", ({ target }) => {
    const at = target.closest("button");
    if (!at) return;
    if ("close" in at.dataset) toggle();
    else if ("list" in at.dataset) list();
    else if (at.dataset.open) open(at.dataset.open);
    else if ("setUp" in at.dataset) {
      delete known.done[shown];
      mark();
      arrange(lessons.find(({ key }) => key === shown));
    } else if (at.dataset.answer) {
      known.answers[shown] = Number(at.dataset.answer);
      keep();
      answered();
    }
  });

  async function toggle() {
    if (!card.hidden) {
      card.hidden = true;
      return;
    }
    lessons ??= await (await fetch("lessons.json")).json();
    card.hidden = false;
    if (!shown) list();
  }

  Object.assign(window.hectorscope, { lessons: { toggle, open } });
})();
