"use strict";
/* Loads three.js from the texts of its released files. A page opened from disk may import no other
   file but may import blobs that it made itself. A blob has no place for "./" to start from and the
   page has no server for "three" to be looked up on, so each import gets the URL of the blob made
   before it. Only this script says import(): a browser too old to read it still runs the others. */
Report.library = async () => {
  const urls = new Map();
  const linked = (text) => text.replace(/\bfrom\s*(["'])([^"'\s]+)\1/g, (whole, quote, name) => (
    urls.has(name) ? "from" + quote + urls.get(name) + quote : whole
  ));
  const hold = document.createElement("script");
  try {
    for (const [name, text] of JSON.parse(document.getElementById("library").textContent)) {
      urls.set(name, URL.createObjectURL(new Blob([linked(text)], { type: "text/javascript" })));
    }
    /* The page counts as loaded, and is printed, only when its module scripts are there. */
    Object.assign(hold, { type: "module", src: [...urls.values()].pop() });
    document.body.append(hold);
    const modules = await Promise.all([...urls.values()].map((url) => import(url)));
    return Object.assign({}, ...modules);
  } finally {
    hold.remove();
    urls.forEach((url) => URL.revokeObjectURL(url));
  }
};
