// SPDX-License-Identifier: Apache-2.0
import type { Member } from '../model/store';
import { Part, h } from './part';

const WORDS = /(#.*$)|(^\s*\[\[?[^\]]*\]\]?)|(^\s*[\w.-]+(?=\s*=))/;

// The scene file as it would be saved, to read.
export class TextPanel extends Part {
  protected readonly watches: Member[] = ['state', 'tab'];
  private code = h('code', {});
  private shown = '';

  protected build(): void {
    const copy = h('button', { onclick: () => void navigator.clipboard?.writeText(this.now.state?.text ?? '').catch(() => undefined) }, 'Copy');
    this.append(h('div', { class: 'actions' }, copy), h('pre', { tabindex: 0, 'aria-label': 'The scene file, read only' }, this.code));
  }

  protected update(): void {
    const { state, tab } = this.now;
    if (tab !== 'text' || !state || state.text === this.shown) return;
    this.shown = state.text;
    this.code.replaceChildren(...state.text.split('\n').flatMap((line) => [...coloured(line), '\n']));
  }
}

// A comment, a table's name and a key each as a span.
function coloured(line: string): (Node | string)[] {
  const found = WORDS.exec(line);
  if (!found) return [line];
  const before = line.slice(0, found.index);
  const rest = line.slice(found.index + found[0].length);
  const isComment = found[1] !== undefined;
  const kind = isComment ? 'comment' : found[2] !== undefined ? 'table' : 'key';
  if (isComment && /"[^"]*$/.test(before)) return [line]; // a # within a string
  const comment = isComment ? -1 : rest.search(/\s#[^"]*$/);
  const tail = comment < 0 ? [rest] : [rest.slice(0, comment), h('span', { class: 'comment' }, rest.slice(comment))];
  return [before, h('span', { class: kind }, found[0]), ...tail];
}
