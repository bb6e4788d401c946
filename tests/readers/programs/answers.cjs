// Prints what `answer` makes of the text of each file named, by its path.
const fs = require('fs');
exports.print = (answer) => {
  const made = {};
  for (const path of process.argv.slice(2)) made[path] = answer(fs.readFileSync(path, 'latin1'));
  fs.writeFileSync(1, JSON.stringify(made));
};
// The entities of a file, blocks that are inserted where they are in place of their names; points say no curve.
exports.drawn = (file) => file.entities
  .flatMap((one) => (one.type === 'INSERT' && unturned(one) ? file.blocks[one.name].entities : [one]))
  .filter((one) => one.type !== 'POINT');
function unturned(one) {
  const at = one.position || one.insertionPoint;
  return !at.x && !at.y && !one.rotation && (one.xScale ?? 1) === 1 && (one.yScale ?? 1) === 1;
}
