// SPDX-License-Identifier: Apache-2.0
import type {Member, Notice} from '../model/store';
import {Keyed, Part, attribute, button, h, text} from './part';

const INFO_MS = 5000;

// Lines for the user: no connection, a text that cannot be used, a change on disk with its two answers, and what the
// server says.
export class NoticeBar extends Part {
  protected readonly watches: Member[] =
      ['notices', 'connected', 'everConnected', 'refused', 'state', 'planProblem', 'busy', 'progress', 'pending'];
  private lost = h('p', {class: 'notice error'});
  private problem = h('p', {class: 'notice error'});
  private progress = h('p', {class: 'notice info'});
  private journal = h('p', {class: 'notice warning'});
  private disk = h('p', {class: 'notice warning'});
  private list = h('div', {});
  private notices = new Keyed<Notice, HTMLElement>(
      this.list, (notice) => this.make(notice),
      (element, notice) => attribute(element, 'class', `notice ${notice.kind}`));

  protected build(): void {
    this.setAttribute('role', 'status');
    this.disk.append(
        h('span', {}, 'Another program has changed the file. If you keep yours, the next save replaces what it wrote.'),
        button('Take the file', () => void this.studio.reload()), button('Keep mine', () => void this.studio.keep()));
    this.append(this.lost, this.problem, this.journal, this.disk, this.progress, this.list);
  }

  protected update(): void {
    const {connected, everConnected, refused, state, planProblem, notices, busy, progress, pending} = this.now;
    this.lost.hidden = connected || !(everConnected || refused);
    text(
        this.lost,
        refused ?
            'No connection to airtruth studio. It serves at most eight pages: close another one. If it was started again, open the address that it prints.' :
            `No connection to airtruth studio. What you do waits in this tab and is sent when it is back. If it was started again, open the address that it prints${
                pending ? ` in this tab: at another port, or in another tab, what waits (${pending}) is lost` : ''}.`);
    const problem = state?.problem ?? planProblem;
    this.problem.hidden = !problem;
    text(this.problem, problem ?? '');
    this.journal.hidden = !state?.journal_fault || state.saved;
    text(this.journal, state?.journal_fault ?? '');
    this.disk.hidden = !state?.changed_on_disk;
    const isMeasured =
        progress !== null && busy !== 'render' && (progress.total === 0 || progress.done < progress.total);
    this.progress.hidden = !isMeasured;
    text(
        this.progress,
        isMeasured ? `Measuring ${progress!.of === 'motion' ? 'the motion of the clip' : 'the camera'}${
                         progress!.total ? `: ${progress!.done} of ${progress!.total}` : ' …'}` :
                     '');
    this.notices.show(notices.map((notice) => ({key: notice.line, item: notice})));
  }

  private make(notice: Notice): HTMLElement {
    if (notice.kind === 'info') setTimeout(() => this.studio.store.unsay(notice.line), INFO_MS);
    return h(
        'p', {}, h('span', {}, notice.line),
        button('×', () => this.studio.store.unsay(notice.line), {class: 'small', 'aria-label': 'Dismiss'}));
  }
}
customElements.define('studio-notices', NoticeBar);
