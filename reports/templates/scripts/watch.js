/* A page of linkproof watch: it follows its file, and saves to it. */
"use strict";
linkproof.watched = (() => {
  const EVERY = 500; // ms
  const ENDED = "linkproof watch has ended: start it again.";
  const state = document.querySelector('meta[name="linkproof-state"]')?.content;
  if (!state) return null;
  let isSaving = false;

  async function follow() {
    const now = await fetch("state").then((answer) => answer.text(), () => null);
    if (now === null) document.querySelector(".subtitle").textContent = ENDED;
    else if (isSaving || now === state) setTimeout(follow, EVERY);
    else location.reload();
  }

  /* Write a text over the file that this page shows, and show the new one; gives why it was not written. Then the page
     stays as it is, with all that is changed on it. */
  async function save(text) {
    isSaving = true;
    const answer = await fetch("save", { method: "POST", body: text, headers: { "If-Match": state } }).catch(() => null);
    if (!answer?.ok) return answer ? answer.text() : ENDED;
    location.reload();
    return "";
  }

  setTimeout(follow, EVERY);
  return { save };
})();
