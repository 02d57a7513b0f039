// What the compiler's preprocessor would leave out, left out before: so that only those uniforms are
// handed on that a variant reads. Lines keep their numbers.

const OPERATORS = [
  { "||": (a, b) => Number(a || b) },
  { "&&": (a, b) => Number(a && b) },
  { "==": (a, b) => Number(a === b), "!=": (a, b) => Number(a !== b) },
  {
    "<=": (a, b) => Number(a <= b), ">=": (a, b) => Number(a >= b),
    "<": (a, b) => Number(a < b), ">": (a, b) => Number(a > b),
  },
  { "+": (a, b) => a + b, "-": (a, b) => a - b },
];
const TOKEN = /\s*(\|\||&&|[=!<>]=|[<>!()+-]|\w+)/y;

/** The value of a condition of #if; constants: a Map of names to texts. */
export function conditionOf(text, constants) {
  const tokens = [];
  TOKEN.lastIndex = 0;
  for (let match = TOKEN.exec(text); match; match = TOKEN.exec(text)) tokens.push(match[1]);
  let at = 0;
  const take = () => tokens[at++];

  function level(depth) {
    if (depth === OPERATORS.length) return single();
    let value = level(depth + 1);
    while (tokens[at] in OPERATORS[depth]) {
      const operator = OPERATORS[depth][take()];
      value = operator(value, level(depth + 1));
    }
    return value;
  }

  function single() {
    const token = take();
    if (token === "!") return Number(!single());
    if (token === "(") {
      const value = level(0);
      take(); // )
      return value;
    }
    if (token === "defined") {
      const wrapped = tokens[at] === "(";
      if (wrapped) take();
      const known = constants.has(take());
      if (wrapped) take();
      return Number(known);
    }
    if (/^\d/.test(token)) return parseInt(token, 10);
    return constants.has(token) ? conditionOf(constants.get(token), constants) : 0;
  }

  return level(0);
}

/** Lines with those emptied that conditions leave out, and the conditions themselves. */
export function activeLines(lines) {
  const constants = new Map();
  const open = []; // of each #if: {active, taken, outer}
  const isActive = () => open.length === 0 || open[open.length - 1].active;
  return lines.map((line) => {
    const match = /^\s*#\s*(\w+)\b\s*(.*?)\s*(?:\/\/.*)?$/.exec(line);
    const [, word, rest] = match ?? [null, "", ""];
    const last = open[open.length - 1];
    if (word === "if" || word === "ifdef" || word === "ifndef") {
      const outer = isActive();
      const met =
        outer &&
        (word === "if"
          ? Boolean(conditionOf(rest, constants))
          : constants.has(rest) === (word === "ifdef"));
      open.push({ active: met, taken: met, outer });
    } else if (word === "elif") {
      const met = last.outer && !last.taken && Boolean(conditionOf(rest, constants));
      Object.assign(last, { active: met, taken: last.taken || met });
    } else if (word === "else") {
      last.active = last.outer && !last.taken;
      last.taken = true;
    } else if (word === "endif") {
      open.pop();
    } else {
      if (!isActive()) return word === "line" ? line : "";
      const defined = word === "define" ? /^(\w+)(?:\s+(.*))?$/.exec(rest) : null;
      if (defined) constants.set(defined[1], defined[2] ?? "");
      if (word === "undef") constants.delete(rest);
      return line;
    }
    return "";
  });
}
