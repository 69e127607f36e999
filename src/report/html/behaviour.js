"use strict";
(() => {
  const by = (id) => document.getElementById(id);
  const all = (selector, within = document) => [...within.querySelectorAll(selector)];
  const slider = by("time"), play = by("play"), now = by("now"), list = by("timeline");
  const still = matchMedia("(prefers-reduced-motion: reduce)");

  // "seconds x y degrees;" for each sample, "seconds;" for one elsewhere.
  const samples = (text) => text.split(";").filter(Boolean).map((one) => one.split(" ").map(Number));
  const movers = all(".mover").map((group) => ({
    group,
    turn: group.querySelector(".turn"),
    robot: group.classList.contains("robot"),
    gone: group.ownerSVGElement.querySelector(".gone"),
    track: samples(group.dataset.track),
  }));
  const moments = all(".moment").map((item) => ({ item, at: Number(item.dataset.at) }));
  const end = Number(slider.max);
  let time = Number(slider.dataset.opening);

  const clock = (seconds) => {
    const two = (number) => String(Math.floor(number)).padStart(2, "0");
    return two(seconds / 60) + ":" + two(seconds % 60);
  };

  /** Index of the last entry that is not later than a time, or -1. */
  const last = (entries, at, when) => {
    let low = 0, high = entries.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (when(entries[middle]) <= at) low = middle + 1; else high = middle;
    }
    return low - 1;
  };

  const place = ({ group, turn, robot, gone, track }, at) => {
    const index = last(track, at, (sample) => sample[0]);
    const from = track[index], to = track[index + 1];
    if (from === undefined || from.length < 4) {
      group.setAttribute("visibility", "hidden");
    } else {
      let [, x, y, degrees] = from;
      if (to !== undefined && to.length === 4) {
        const share = (at - from[0]) / (to[0] - from[0] || 1);
        const turned = ((to[3] - degrees + 540) % 360 + 360) % 360 - 180;
        x += (to[1] - x) * share;
        y += (to[2] - y) * share;
        degrees += turned * share;
      }
      group.removeAttribute("visibility");
      group.setAttribute("transform", `translate(${x.toFixed(1)} ${y.toFixed(1)})`);
      turn.setAttribute("transform", `rotate(${degrees.toFixed(1)})`);
    }
    if (robot && gone) {
      let path = "", on = false;
      for (const sample of track.slice(0, index + 1)) {
        if (sample.length === 4) path += `${on ? "L" : "M"}${sample[1]} ${sample[2]}`;
        on = sample.length === 4;
      }
      gone.setAttribute("d", path);
    }
  };

  let current = null;
  const show = (at) => {
    time = Math.min(Math.max(at, 0), end);
    slider.value = String(Math.floor(time));
    by("clock").textContent = clock(time);
    movers.forEach((mover) => place(mover, time));
    // A moment is a second, so that the slider's whole seconds reach it.
    const moment = moments[last(moments, time, (one) => Math.floor(one.at))];
    const told = moment ? all(".told p", moment.item).map((line) => line.firstChild.nodeType === 3
      ? line.firstChild.textContent : line.childNodes[1].textContent.trim()).join(" ") : "";
    slider.setAttribute("aria-valuetext", clock(time) + (told ? ". " + told : ""));
    if (moment === current) return;
    current = moment;
    now.textContent = told;
    for (const { item } of moments) item.removeAttribute("aria-current");
    if (moment) {
      moment.item.setAttribute("aria-current", "time");
      const { offsetTop, offsetHeight } = moment.item;
      if (offsetTop < list.scrollTop || offsetTop + offsetHeight > list.scrollTop + list.clientHeight) {
        list.scrollTop = offsetTop - list.clientHeight / 3;
      }
    }
  };

  let frame = 0, before = 0;
  const pause = () => {
    cancelAnimationFrame(frame);
    clearTimeout(frame);
    frame = 0;
    play.textContent = "Play";
    now.removeAttribute("aria-live");
  };
  const step = (stamp) => {
    if (time >= end) return pause();
    if (still.matches) {
      // Without motion: from moment to moment.
      const next = moments.find(({ at }) => Math.floor(at) > time);
      show(next ? next.at : end);
      frame = setTimeout(step, 2000);
      return;
    }
    show(time + (stamp - before) / 1000 * Number(by("speed").value));
    before = stamp;
    frame = requestAnimationFrame(step);
  };
  play.addEventListener("click", () => {
    if (frame) return pause();
    if (time >= end) show(0);
    play.textContent = "Pause";
    // What goes by while playing is not read out.
    now.setAttribute("aria-live", "off");
    before = performance.now();
    if (still.matches) step(before); else frame = requestAnimationFrame(step);
  });
  slider.addEventListener("input", () => { pause(); show(Number(slider.value)); });
  for (const button of all(".seek")) {
    button.disabled = false;
    button.addEventListener("click", () => { pause(); show(Number(button.dataset.at)); });
  }
  for (const link of all(".to-decision")) {
    link.addEventListener("click", () => {
      pause();
      show(Number(link.dataset.at));
      document.querySelector(link.getAttribute("href")).focus();
    });
  }
  by("player").hidden = false;
  show(time);
})();
