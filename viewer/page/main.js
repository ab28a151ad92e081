// What happens when: time goes on, sizes change, buttons are pressed.

const view = document.getElementById("view"), line = document.getElementById("line"), clock = document.getElementById("clock");
const state = { time: first, playing: false, speed: 1, resume: false, drawn: false };

function redraw() {
  if (state.drawn) return;
  state.drawn = true;
  requestAnimationFrame(paint);
}

function paint(now) {
  state.drawn = false;
  if (state.playing) {
    const passed = state.since === undefined ? 0 : Math.max(0, Math.min(0.1, (now - state.since) / 1000));
    state.since = now;
    state.time += passed * state.speed;
    if (state.time >= last) {
      // the end is seen for a moment, then it begins again
      state.time = last;
      state.rest = (state.rest || 0) + passed;
      if (state.rest > 0.8) [state.time, state.rest] = [first, 0];
    }
    redraw();
  }
  const ratio = window.devicePixelRatio || 1, g = view.getContext("2d");
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  drawScene(g, state.time);
  if (still) return;
  drawTimeline(line, state.time);
  drawPlots(state.time);
  tellEvent(state.time);
  const digits = Math.max(0, Math.min(9, 3 - Math.floor(Math.log10(last - first))));
  clock.replaceChildren(`${state.time.toFixed(digits)} s `, Object.assign(document.createElement("small"), { textContent: `of ${Number(last.toPrecision(4))} s` }));
}

function setButton() {
  const button = document.getElementById("play");
  button.querySelector("path").setAttribute("d", state.playing ? "M4 2.5h3v11H4zM9 2.5h3v11H9z" : "M4 2.5v11l9-5.5z");
  button.setAttribute("aria-label", state.playing ? "Pause" : "Play");
}

function play() {
  if (still) return;
  if (state.time >= last) state.time = first;
  state.playing = true;
  state.since = undefined;
  state.rest = 0;
  setButton();
  redraw();
}

function pause() {
  state.playing = false;
  setButton();
  redraw();
}

function seek(time) {
  state.time = Math.min(Math.max(time, first), last);
  state.rest = 0;
  redraw();
}

function resized() {
  const ratio = window.devicePixelRatio || 1;
  camera.width = view.clientWidth;
  camera.height = view.clientHeight;
  view.width = Math.round(camera.width * ratio);
  view.height = Math.round(camera.height * ratio);
  sized();
  if (!camera.moved) fit();
  for (const card of cards) card.picture = null;
  redraw();
}

const resizes = new ResizeObserver(resized);
document.getElementById("title").textContent = scene.title;
document.getElementById("facts").textContent = still ? "" : `${shown(last - first, "s")}, ${scene.events.length} event${scene.events.length === 1 ? "" : "s"}`;
document.getElementById("notes").textContent = scene.notes.join(" ");
if (still) document.getElementById("app").classList.add("still");
addShows();
addLegend();
addSpeeds();
listKinds();
watchKeys();
watchView(view, redraw);
watchTime(line, (x) => first + ((x - EDGE) / (line.clientWidth - 2 * EDGE)) * (last - first));
document.getElementById("play").addEventListener("click", () => (state.playing ? pause() : play()));
document.getElementById("before").addEventListener("click", () => { pause(); seek(neighbour(state.time, false)); });
document.getElementById("after").addEventListener("click", () => { pause(); seek(neighbour(state.time, true)); });
document.getElementById("closer").addEventListener("click", () => zoomMiddle(1.25));
document.getElementById("farther").addEventListener("click", () => zoomMiddle(0.8));
document.getElementById("fit").addEventListener("click", () => { fit(); redraw(); });
document.getElementById("more").addEventListener("click", () => {
  const used = new Set(cards.map((card) => card.select.value));
  addCard((scene.tracks.find((track) => !used.has(track.name)) || scene.tracks[0]).name);
});
document.getElementById("more").hidden = !scene.tracks.length;
for (const name of scene.plots) addCard(name);
resizes.observe(view);
dark.addEventListener("change", resized);
resized();

// #t=0.5 opens the page at that time; without it it plays, unless the reader wants no movement
const asked = new URLSearchParams(location.hash.slice(1)).get("t");
if (asked !== null) seek(Number(asked));
else if (!window.matchMedia("(prefers-reduced-motion: reduce)").matches) play();

const extras = D === 3 ? { ready, placed } : { ready: Promise.resolve() };

// For whoever drives the page from outside: tests, slides.
window.tlismni = { scene, state, camera, play, pause, seek, paint, place, pose, toScreen, ...extras };
