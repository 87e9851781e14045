(* SPDX-License-Identifier: BSD-3-Clause *)
(** * That pairs which are not checked have the reasons that the world gives *)
From Coq Require Import ZArith Lia String Bool List.
From FclArtic Require Import Statement.
Import ListNotations.

(** ** Between two frames

    A parent's number is below that of its frame, so of two frames the one of the larger number is not the common
    ancestor. *)
Fixpoint between (fuel : nat) (w : world) (f g : nat) : option (nat * list nat * list nat) :=
  if Nat.eqb f g then Some (f, [], [])
  else
    match fuel with
    | O => None
    | S n =>
        if Nat.ltb g f then
          match frame_at w f with
          | Some x => match between n w (parent x) g with Some (c, up, down) => Some (c, f :: up, down) | None => None end
          | None => None
          end
        else
          match frame_at w g with
          | Some x => match between n w f (parent x) with Some (c, up, down) => Some (c, up, g :: down) | None => None end
          | None => None
          end
    end.

(** Whether frame i or one above it moves. *)
Fixpoint moves_at_all (fuel : nat) (w : world) (i : nat) : bool :=
  moves w i ||
  match fuel, frame_at w i with S n, Some f => moves_at_all n w (parent f) | _, _ => false end.

Definition role_is (r : role) (b : body) : bool :=
  match r, body_role b with link, link | carried, carried | obstacle, obstacle => true | _, _ => false end.

Definition reason_ok (w : world) (why : reason) (a b : body) : bool :=
  let fuel := (body_frame a + body_frame b)%nat in
  match why with
  | allowed => true
  | touch_link =>
      negb (role_is obstacle a) && negb (role_is obstacle b) && (role_is carried a || role_is carried b)
  | still =>
      match between fuel w (body_frame a) (body_frame b) with
      | Some (_, up, down) => forallb (fun i => negb (moves w i)) (up ++ down)
      | None => false
      end
  | neighbours =>
      role_is link a && role_is link b &&
      match between fuel w (body_frame a) (body_frame b) with
      | Some (c, up, down) =>
          let l := up ++ down in
          Nat.leb (length (filter (moves w) l)) 1 &&
          forallb (fun i => Nat.eqb i (body_frame a) || Nat.eqb i (body_frame b) ||
                            negb (existsb (fun d => role_is link d && Nat.eqb (body_frame d) i) (bodies w))) (c :: l) &&
          forallb (fun i => match frame_at w i with
                            | Some f => negb (free [] (elements f)) || moves_at_all i w (parent f)
                            | None => true end) l
      | None => false
      end
  end.

(** All bodies of the one name with all of the other, in both orders. *)
Definition reasons_ok (w : world) : bool :=
  forallb (fun u =>
    let one := filter (fun b => String.eqb (one_name u) (body_name b)) (bodies w) in
    let other := filter (fun b => String.eqb (other_name u) (body_name b)) (bodies w) in
    let has a b := Nat.eqb (body_frame a) (body_frame b) || (is_obstacle a && is_obstacle b) || reason_ok w (why u) a b in
    forallb (fun a => forallb (fun b => has a b && has b a) other) one) (unchecked w).

(** ** Proofs *)

Lemma between_ok w fuel : forall f g c up down, between fuel w f g = Some (c, up, down) ->
  way_up w f c up /\ way_up w g c down.
Proof.
  induction fuel as [|n IH]; intros f g c up down; cbn [between]; destruct (Nat.eqb_spec f g) as [->|D]; try discriminate;
    try (intros [= <- <- <-]; split; constructor).
  destruct (Nat.ltb g f).
  - destruct (frame_at w f) as [x|] eqn:X; [|discriminate].
    destruct (between n w (parent x) g) as [[[c' u] d]|] eqn:B; [|discriminate].
    intros [= <- <- <-]. destruct (IH _ _ _ _ _ B) as [U L]. split; [eapply one_up; eassumption | exact L].
  - destruct (frame_at w g) as [x|] eqn:X; [|discriminate].
    destruct (between n w f (parent x)) as [[[c' u] d]|] eqn:B; [|discriminate].
    intros [= <- <- <-]. destruct (IH _ _ _ _ _ B) as [U L]. split; [exact U | eapply one_up; eassumption].
Qed.

Lemma moves_at_all_ok w fuel : forall i, moves_at_all fuel w i = true -> exists k up, way_up w i k up /\ moves w k = true.
Proof.
  induction fuel as [|n IH]; intros i; cbn [moves_at_all]; destruct (moves w i) eqn:M; cbn [orb]; intros H;
    try (exists i, []; split; [constructor | exact M]); try discriminate.
  destruct (frame_at w i) as [f|] eqn:F; [|discriminate].
  destruct (IH _ H) as (k & up & U & K). exists k, (i :: up). split; [eapply one_up; eassumption | exact K].
Qed.

Lemma role_is_ok r b : role_is r b = true <-> body_role b = r.
Proof. unfold role_is. destruct r, (body_role b); split; congruence. Qed.

Lemma reason_ok_ok w y a b : reason_ok w y a b = true -> reason_holds w y a b.
Proof.
  unfold reason_ok. destruct y; cbn [reason_holds].
  - destruct (between _ w _ _) as [[[c up] down]|] eqn:B; [|discriminate]. apply between_ok in B. destruct B as [U D].
    rewrite forallb_forall. intros H. exists c, (up ++ down). split; [exists up, down; auto|].
    intros i I. specialize (H i I). destruct (moves w i); [discriminate | reflexivity].
  - rewrite !andb_true_iff, !role_is_ok. intros [[La Lb] H]. split; [exact La|]. split; [exact Lb|].
    destruct (between _ w _ _) as [[[c up] down]|] eqn:B; [|discriminate]. apply between_ok in B. destruct B as [U D].
    cbv zeta in H. rewrite !andb_true_iff, !forallb_forall in H. destruct H as [[H1 H2] H3]. apply Nat.leb_le in H1.
    exists c, (up ++ down). split; [exists up, down; auto|]. split; [exact H1|]. split.
    + intros i d I Na Nb Id Ld E. specialize (H2 i I). rewrite !orb_true_iff, !Nat.eqb_eq in H2.
      destruct H2 as [[H2|H2]|H2]; [tauto | tauto|]. apply negb_true_iff in H2.
      assert (K : existsb (fun d => role_is link d && Nat.eqb (body_frame d) i) (bodies w) = true); [|congruence].
      apply existsb_exists. exists d. split; [exact Id|]. apply andb_true_iff. split; [apply role_is_ok; exact Ld|].
      apply Nat.eqb_eq. exact E.
    + intros i f I F Fr. specialize (H3 i I). rewrite F, Fr in H3. cbn [negb orb] in H3. exact (moves_at_all_ok w i _ H3).
  - intros _. exact I.
  - rewrite !andb_true_iff, !negb_true_iff, orb_true_iff, !role_is_ok. intros [[Na Nb] C].
    split; [|split; [|exact C]]; intros E; apply role_is_ok in E; congruence.
Qed.

Lemma reasons_ok_ok w : reasons_ok w = true -> reasons w.
Proof.
  unfold reasons_ok. rewrite forallb_forall. intros H a b u Ia Ib Iu NF NO N. specialize (H u Iu). cbv zeta in H.
  rewrite forallb_forall in H.
  assert (PICK : forall x, In x (bodies w) -> forall n, String.eqb n (body_name x) = true ->
    In x (filter (fun b => String.eqb n (body_name b)) (bodies w))) by (intros x Ix n E; apply filter_In; auto).
  assert (NF' : Nat.eqb (body_frame a) (body_frame b) = false) by (apply Nat.eqb_neq; exact NF).
  assert (NF'' : Nat.eqb (body_frame b) (body_frame a) = false) by (apply Nat.eqb_neq; auto).
  assert (NO' : is_obstacle b && is_obstacle a = false) by (rewrite andb_comm; exact NO).
  unfold same_names in N. apply orb_true_iff in N. rewrite !andb_true_iff in N.
  destruct N as [[N1 N2]|[N1 N2]].
  - specialize (H a (PICK a Ia _ N1)). rewrite forallb_forall in H. specialize (H b (PICK b Ib _ N2)).
    apply andb_true_iff in H. destruct H as [H _]. rewrite NF', NO in H. cbn [orb] in H. apply reason_ok_ok. exact H.
  - specialize (H b (PICK b Ib _ N1)). rewrite forallb_forall in H. specialize (H a (PICK a Ia _ N2)).
    apply andb_true_iff in H. destruct H as [_ H]. rewrite NF', NO in H. cbn [orb] in H. apply reason_ok_ok. exact H.
Qed.
