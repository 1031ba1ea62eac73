/* The student's own progress above the contents page: what Validate has seen pass.

The course's server reads it from a file of the student's; nothing is sent anywhere else. It is
shown when the page is opened, and again whenever the page comes to the front. */

const URL_PATH = 'my_robot_basics/progress';
const KEY = 'my_robot_basics';

function element(tag, className, ...content) {
  const made = document.createElement(tag);
  if (className) made.className = `mrb-progress-${className}`;
  made.append(...content);
  return made;
}

const STYLE = `
  .mrb-progress { position: absolute; inset: 0; overflow: auto; border-bottom: 1px solid var(--jp-border-color2); background: var(--jp-layout-color1); color: var(--jp-ui-font-color1); font-size: var(--jp-ui-font-size1); line-height: 1.5; }
  .mrb-progress-content { padding: 8px 16px; }
  .mrb-progress h2 { margin: 0; font-size: var(--jp-ui-font-size2); font-weight: 600; }
  .mrb-progress p { margin: 2px 0; overflow-wrap: anywhere; }
  .mrb-progress ul { display: flex; flex-wrap: wrap; gap: 4px 20px; margin: 6px 0; padding: 0; list-style: none; }
  .mrb-progress-lesson { display: flex; flex-wrap: wrap; }
  .mrb-progress-lesson > a { color: var(--jp-content-link-color, #0b57d0); font-weight: 600; text-decoration: underline; cursor: pointer; padding-right: 4px; }
  .mrb-progress-exercise { margin-right: 10px; white-space: nowrap; }
  .mrb-progress-exercise code { font-family: var(--jp-code-font-family); }
  .mrb-progress-mark { font-weight: bold; }
  .mrb-progress-passed .mrb-progress-mark { color: var(--jp-success-color1); }
  .mrb-progress-changed { font-weight: 600; }
  .mrb-progress-about { color: var(--jp-ui-font-color2); }
`;

function showExercise({ name, state, mark, words }) {
  const sign = element('span', 'mark', mark);
  sign.setAttribute('role', 'img');
  sign.setAttribute('aria-label', words);
  const shown = element('span', `exercise mrb-progress-${state.replace(' ', '-')}`, sign, ' ');
  shown.append(Object.assign(document.createElement('code'), { textContent: name }));
  shown.title = words;
  return shown;
}

/** Show what each mark means, once for each that is there. */
function showLegend(lessons) {
  const meanings = new Map(lessons.flatMap(lesson => lesson.exercises).map(each => [each.mark, each.words]));
  return element('p', 'legend', [...meanings].map(([mark, words]) => `${mark} ${words}`).join(' · '));
}

function showProgress(node, told, open) {
  const lessons = told.lessons.map(({ title, path, exercises }) => {
    const [number] = title.split(' ');
    const link = Object.assign(document.createElement('a'), { textContent: number, title, href: '#' });
    link.setAttribute('aria-label', title);
    link.addEventListener('click', event => {
      event.preventDefault();
      open(path);
    });
    return element('li', 'lesson', link, ...exercises.map(showExercise));
  });
  const notes = told.notes.map(note => element('p', 'note', note));
  const heading = element('h2', '', told.title);
  node.replaceChildren(heading, element('p', '', told.summary), ...notes, element('ul', '', ...lessons));
  node.append(showLegend(told.lessons), element('p', 'about', told.about));
}

/** Put the progress above a notebook that is a contents page. */
export function makeFactory(app, { services, coreutils, widgets }) {
  const contents = app.serviceManager.contents;

  async function refresh(panel, node) {
    const path = contents.localPath(panel.context.path);
    const settings = services.ServerConnection.makeSettings();
    const address = coreutils.URLExt.join(settings.baseUrl, URL_PATH);
    const query = coreutils.URLExt.objectToQueryString({ path });
    try {
      const response = await services.ServerConnection.makeRequest(address + query, {}, settings);
      if (!response.ok) throw new Error(`the server answered ${response.status} ${response.statusText}`);
      const told = await response.json();
      if (told.failed) throw new Error(told.failed);
      const folder = coreutils.PathExt.dirname(path);
      showProgress(node, told, lesson =>
        app.commands.execute('docmanager:open', { path: coreutils.PathExt.join(folder, lesson) }));
    } catch (error) {
      node.replaceChildren(element('p', '', `Your progress could not be shown: ${error.message}`));
    }
  }

  class Shown extends widgets.Widget {
    constructor(panel) {
      super({ node: document.createElement('section') });
      this.panel = panel;
      this.addClass('mrb-progress');
      this.content = element('div', 'content');
      this.node.append(this.content);
      this.observer = new ResizeObserver(() => this.makeRoom());
      this.observer.observe(this.content);
    }
    /** Tell the layout how high this is: it asks the header's style alone. */
    makeRoom() {
      const height = Math.min(this.content.offsetHeight + 1, 0.45 * this.panel.node.offsetHeight);
      this.panel.contentHeader.node.style.minHeight = `${height}px`;
      this.panel.fit();
    }
    refresh() {
      void refresh(this.panel, this.content);
    }
    onAfterAttach() {
      this.refresh();
    }
    onAfterShow() {
      this.refresh();
    }
    onResize() {
      this.makeRoom();
    }
    dispose() {
      this.observer.disconnect();
      super.dispose();
    }
  }

  document.head.append(Object.assign(document.createElement('style'), { textContent: STYLE }));
  return {
    createNew(panel) {
      void panel.context.ready.then(() => {
        if (!panel.isDisposed && panel.content.model?.getMetadata(KEY)?.contents)
          panel.contentHeader.addWidget(new Shown(panel));
      });
    }
  };
}
