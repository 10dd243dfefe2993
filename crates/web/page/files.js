// Files that a person gives to the page: dropped anywhere on it, or chosen.

import { byId } from './elements.js';

export class FileDrop {
  // `give` gets pairs of a path and the bytes in an ArrayBuffer, `problem` what is wrong.
  constructor(give, problem) {
    const take = (reading) => reading.then(give).catch((error) => problem(error.message));
    byId('files').addEventListener('change', ({ target }) => {
      if (target.files.length > 0) {
        take(read([...target.files].map((file) => [file.name, file])));
      }
    });
    const note = byId('drop-note');
    document.addEventListener('dragover', (event) => {
      event.preventDefault();
      note.hidden = false;
    });
    document.addEventListener('dragleave', ({ relatedTarget }) => {
      note.hidden = relatedTarget === null;
    });
    document.addEventListener('drop', (event) => {
      event.preventDefault();
      note.hidden = true;
      take(dropped(event.dataTransfer).then(read));
    });
  }
}

// What was dropped, folders with all that is in them: pairs of a path and a file.
async function dropped({ items }) {
  // All are asked before the first wait, after which there are none any more.
  const all = [...items].filter(({ kind }) => kind === 'file')
    .map((item) => item.webkitGetAsEntry?.() ?? item.getAsFile());
  const files = await Promise.all(all.map((each) => (
    each instanceof File ? [[each.name, each]] : entries(each))));
  return files.flat();
}

async function entries(entry) {
  if (entry.isFile) {
    const file = await new Promise((resolve, reject) => entry.file(resolve, reject));
    return [[entry.fullPath.replace(/^\//, ''), file]];
  }
  const reader = entry.createReader();
  const found = [];
  // A reader gives some at a time, and none at the end.
  for (;;) {
    const some = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (some.length === 0) {
      break;
    }
    found.push(...some);
  }
  return (await Promise.all(found.map(entries))).flat();
}

// The bytes of files.
async function read(files) {
  if (files.length === 0) {
    throw new Error('what was dropped is no file');
  }
  return Promise.all(files.map(async ([path, file]) => {
    try {
      return [path, await file.arrayBuffer()];
    } catch (error) {
      throw new Error(`${path} cannot be read: ${error.message}`);
    }
  }));
}
