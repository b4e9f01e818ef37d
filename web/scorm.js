// Connects the page to a learning platform by SCORM 1.2. `exercise pack` adds this script to the
// page; the page finds it as `gskCourse`.
"use strict";
(() => {
  const began = Date.now();

  // The platform's object `API` is in a window above the page, or above the one that opened it.
  function findApi(start) {
    let candidate = start;
    for (let level = 0; candidate && level < 100; level += 1) {
      try {
        if (candidate.API) return candidate.API;
      } catch {
        return null; // A window of another server.
      }
      if (candidate.parent === candidate) return null;
      candidate = candidate.parent;
    }
    return null;
  }

  function findOpener() {
    try {
      return window.opener || window.top.opener;
    } catch {
      return null;
    }
  }

  const api = findApi(window) || findApi(findOpener());
  const isConnected = api !== null && String(api.LMSInitialize("")) === "true";
  let isFinished = false;

  function get(name) {
    return isConnected ? String(api.LMSGetValue(name) ?? "") : "";
  }

  function set(name, value) {
    return String(api.LMSSetValue(name, value)) === "true";
  }

  function sessionTime() {
    const hundredths = Math.min(Math.floor((Date.now() - began) / 10), 3599999999);
    const pad = (number, width) => String(Math.floor(number)).padStart(width, "0");
    const seconds = hundredths / 100;
    return `${pad(seconds / 3600, 4)}:${pad((seconds / 60) % 60, 2)}:${pad(seconds % 60, 2)}.` +
      pad(hundredths % 100, 2);
  }

  // A platform may lack interactions: the score does not depend on them.
  function addAttempt(attempt) {
    const count = Number.parseInt(get("cmi.interactions._count"), 10);
    if (Number.isNaN(count)) return;
    const names = ["id", "type", "weighting", "student_response", "result", "latency"];
    for (const name of names) set(`cmi.interactions.${count}.${name}`, attempt[name]);
  }

  // Opened for review, nothing is written.
  const isReview = ["review", "browse"].includes(get("cmi.core.lesson_mode"));
  const status = get("cmi.core.lesson_status");
  if (isConnected && !isReview && ["", "not attempted", "unknown"].includes(status)) {
    set("cmi.core.lesson_status", "incomplete");
    api.LMSCommit("");
  }

  window.gskCourse = {
    isConnected,
    learner: get("cmi.core.student_name"),
    suspended: () => get("cmi.suspend_data"),
    // Stores values and a solution that was handed in. Returns whether the platform has them.
    report(text) {
      if (!isConnected || isFinished) return false;
      if (isReview) return true;
      const { values, attempt } = JSON.parse(text);
      const stored = Object.entries(values).map(([name, value]) => set(name, value));
      addAttempt(attempt);
      set("cmi.core.session_time", sessionTime());
      return stored.every(Boolean) && String(api.LMSCommit("")) === "true";
    },
  };

  // The next session continues with the stored progress.
  function finish() {
    if (!isConnected || isFinished) return;
    isFinished = true;
    set("cmi.core.exit", "suspend");
    set("cmi.core.session_time", sessionTime());
    api.LMSCommit("");
    api.LMSFinish("");
  }
  window.addEventListener("pagehide", finish);
})();
