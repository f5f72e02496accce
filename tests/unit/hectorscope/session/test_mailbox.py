import threading

from hectorscope.session.mailbox import Mailbox


def test_only_the_newest_value_is_handed_out_and_only_once():
    """Two puts and one take: the second value; another take finds nothing new."""
    mailbox: Mailbox[int] = Mailbox()
    mailbox.put(1)
    mailbox.put(2)
    assert mailbox.take() == 2
    assert mailbox.take() is None


def test_the_newest_value_can_be_seen_after_it_was_taken():
    """A late joiner sees the state without waiting for news."""
    mailbox: Mailbox[int] = Mailbox()
    assert mailbox.latest is None
    mailbox.put(7)
    mailbox.take()
    assert mailbox.latest == 7


def test_a_waiting_reader_is_woken():
    """Take blocks until somebody puts."""
    mailbox: Mailbox[int] = Mailbox()
    got: list[int | None] = []
    reader = threading.Thread(target=lambda: got.append(mailbox.take(timeout=30.0)))
    reader.start()
    mailbox.put(3)
    reader.join(timeout=30.0)
    assert got == [3]


def test_each_new_value_is_told_at_once():
    """To one function, which is called with it; taking tells nothing."""
    box: Mailbox[int] = Mailbox()
    told: list[int] = []
    box.tell(told.append)
    box.put(1)
    box.take()
    box.put(2)
    assert told == [1, 2]


def test_an_empty_mailbox_gives_none_after_the_wait():
    """Nothing came: None, not an error."""
    assert Mailbox[int]().take(timeout=0.01) is None
