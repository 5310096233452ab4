// SPDX-License-Identifier: Apache-2.0
import type {Member} from '../model/store';
import {Part, button, h} from './part';

const WORDS = /^(\s*\[\[?[^\]]*\]\]?)|^(\s*[\w.-]+)(?=\s*=)/;

// The scene file as it would be saved, to read.
export class TextPanel extends Part {
  protected readonly watches: Member[] = ['state', 'tab'];
  private code = h('code', {});
  private shown = '';

  protected build(): void {
    const copy = () => void navigator.clipboard?.writeText(this.now.state?.text ?? '').catch(() => undefined);
    this.append(
        h('div', {class: 'actions'}, button('Copy', copy)),
        h('pre', {tabindex: 0, 'aria-label': 'The scene file, read only'}, this.code));
  }

  protected update(): void {
    const {state, tab} = this.now;
    if (tab !== 'text' || !state || state.text === this.shown) return;
    this.shown = state.text;
    this.code.replaceChildren(...state.text.split('\n').flatMap((line) => [...coloured(line), '\n']));
  }
}
customElements.define('studio-text', TextPanel);

// A table's name, a key and a comment each as a span.
function coloured(line: string): (Node|string)[] {
  const comment = commentAt(line);
  const words = line.slice(0, comment);
  const found = WORDS.exec(words);
  const parts = found ?
      [h('span', {class: found[1] !== undefined ? 'table' : 'key'}, found[0]), words.slice(found[0].length)] :
      [words];
  return comment < line.length ? [...parts, h('span', {class: 'comment'}, line.slice(comment))] : parts;
}

// Where the comment of a line begins: at a # that is in no string.
function commentAt(line: string): number {
  let quote = '';
  for (let k = 0; k < line.length; ++k) {
    const c = line[k];
    if (quote === '"' && c === '\\')
      ++k;
    else if (quote)
      quote = c === quote ? '' : quote;
    else if (c === '"' || c === '\'')
      quote = c;
    else if (c === '#')
      return k;
  }
  return line.length;
}
